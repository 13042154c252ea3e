// Takes accessors, bufferViews and their bytes out of a document when nothing refers to them any more.
#include "gltf/compact.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "gltf/json_tools.h"
#include "gltf/references.h"

namespace nmc::gltf {
namespace {

/// 8 covers every component type of glTF and the element sizes of meshopt streams.
constexpr std::size_t alignment = 8;

/// Bytes of a buffer that a bufferView holds, and the JSON object (the view, or its meshopt extension) that says so.
struct StoredRange {
  Json* holder = nullptr;
  std::size_t view = 0;
  std::size_t buffer = 0;
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Bytes that stay together, and where they go.
struct Segment {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t new_begin = 0;
};

StoredRange read_range(const Document& document, Json& holder, std::size_t view) {
  const std::string where = document.name + ": bufferViews[" + std::to_string(view) + "]";
  const auto buffer = index_member(holder, "buffer");
  if (!buffer || *buffer >= document.buffers.size()) {
    throw Error(ErrorCode::invalid_input, where + " has no valid buffer; repair the file first");
  }
  const Json* offset = find_member(holder, "byteOffset");
  const auto begin = offset ? as_index(*offset) : 0;
  const auto length = index_member(holder, "byteLength");
  const std::size_t size = document.buffers[*buffer].size();
  if (!begin || !length) {
    throw Error(ErrorCode::invalid_input, where + " has no valid byteOffset and byteLength; repair the file first");
  }
  const bool fits = *begin <= size && *length <= size - *begin;
  if (document.has_data[*buffer] && !fits) {
    throw Error(ErrorCode::invalid_input,
                where + " ends beyond buffers[" + std::to_string(*buffer) + "]; repair the file first");
  }
  return {&holder, view, *buffer, *begin, *begin + *length};
}

/// The stored bytes of all views. A meshopt view has two ranges when its fallback buffer has data, else only the
/// compressed one.
std::vector<StoredRange> stored_ranges(Document& document) {
  std::vector<StoredRange> ranges;
  const auto add = [&](Json& holder, std::size_t view) {
    const auto range = read_range(document, holder, view);
    if (document.has_data[range.buffer]) ranges.push_back(range);
  };
  Json* views = find_member(document.json, "bufferViews");
  if (!views || !views->is_array()) return ranges;
  for (std::size_t view = 0; view < views->size(); ++view) {
    add((*views)[view], view);
    Json* extensions = find_member((*views)[view], "extensions");
    if (!extensions) continue;
    for (const auto* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      if (Json* packed = find_member(*extensions, name)) add(*packed, view);
    }
  }
  return ranges;
}

/// What stays of a buffer: the kept ranges, joined with each other over what lies between them unless that is, in part,
/// removed.
std::vector<Segment> kept_segments(std::vector<const StoredRange*> ranges, const std::set<std::size_t>& removed_views) {
  std::stable_sort(ranges.begin(), ranges.end(),
                   [](const StoredRange* a, const StoredRange* b) { return a->begin < b->begin; });
  std::vector<Segment> segments;
  std::size_t removed_until = 0;
  for (const auto* range : ranges) {
    if (removed_views.contains(range->view)) {
      removed_until = std::max(removed_until, range->end);
      continue;
    }
    const std::size_t last_end = segments.empty() ? 0 : segments.back().end;
    const bool joins = range->begin <= last_end || removed_until <= last_end;
    if (segments.empty()) {
      segments.push_back({joins ? 0 : range->begin, range->end, 0});
    } else if (joins) {
      segments.back().end = std::max(last_end, range->end);
    } else {
      segments.push_back({range->begin, range->end, 0});
    }
  }
  return segments;
}

/// Gives each segment its place after all that lies between them is gone.
void lay_out(std::vector<Segment>& segments) {
  std::size_t position = 0;
  for (auto& segment : segments) {
    position += (segment.begin % alignment + alignment - position % alignment) % alignment;
    segment.new_begin = position;
    position += segment.end - segment.begin;
  }
}

std::size_t moved(std::size_t offset, const std::vector<Segment>& segments) {
  const auto after = std::upper_bound(segments.begin(), segments.end(), offset,
                                      [](std::size_t value, const Segment& segment) { return value < segment.begin; });
  const Segment& segment = *std::prev(after);
  return segment.new_begin + (offset - segment.begin);
}

/// Cuts what only removed views hold out of a buffer; `ranges` are all that lie in it.
void cut_buffer(Document& document, std::size_t buffer, const std::vector<const StoredRange*>& ranges,
                const std::set<std::size_t>& removed_views) {
  auto segments = kept_segments(ranges, removed_views);
  lay_out(segments);
  const Bytes& old_bytes = document.buffers[buffer];
  Bytes bytes(segments.empty() ? 0 : segments.back().new_begin + segments.back().end - segments.back().begin);
  for (const auto& segment : segments) {
    std::copy(old_bytes.begin() + static_cast<std::ptrdiff_t>(segment.begin),
              old_bytes.begin() + static_cast<std::ptrdiff_t>(segment.end),
              bytes.begin() + static_cast<std::ptrdiff_t>(segment.new_begin));
  }
  for (const auto* range : ranges) {
    if (removed_views.contains(range->view)) continue;
    const std::size_t offset = moved(range->begin, segments);
    if (offset != range->begin) (*range->holder)["byteOffset"] = offset;
  }
  document.buffers[buffer] = std::move(bytes);
  document.json["buffers"][buffer]["byteLength"] = document.buffers[buffer].size();
}

std::vector<bool> used_objects(const std::vector<Reference>& references, ObjectKind kind, std::size_t count) {
  std::vector<bool> used(count, false);
  for (const auto& reference : references) {
    if (reference.kind == kind) used[*as_index(*reference.value)] = true;
  }
  return used;
}

std::set<std::size_t> unused_of(const std::set<std::size_t>& candidates, const std::vector<bool>& used) {
  std::set<std::size_t> unused;
  for (const auto index : candidates) {
    if (index < used.size() && !used[index]) unused.insert(index);
  }
  return unused;
}

void add_index(std::set<std::size_t>& indices, const Json* object, std::string_view key) {
  if (!object) return;
  if (const auto index = index_member(*object, key)) indices.insert(*index);
}

void add_views_of(const Json& accessor, std::set<std::size_t>& views) {
  add_index(views, &accessor, "bufferView");
  if (const Json* sparse = find_member(accessor, "sparse")) {
    add_index(views, find_member(*sparse, "indices"), "bufferView");
    add_index(views, find_member(*sparse, "values"), "bufferView");
  }
}

/// Takes the elements out of their array and gives every reference to the others its new number.
void erase_and_renumber(Document& document, ObjectKind kind, const std::set<std::size_t>& removed) {
  if (removed.empty()) return;
  const char* name = array_name(kind);
  const std::size_t count = document.json[name].size();
  constexpr auto gone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> new_index(count, gone);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!removed.contains(i)) new_index[i] = next++;
  }
  for (const auto& reference : find_references(document)) {
    if (reference.kind != kind) continue;
    const std::size_t index = new_index[*as_index(*reference.value)];
    if (index == gone) throw Error(ErrorCode::internal, document.name + ": a used object was removed from " + name);
    *reference.value = index;
  }
  Json left = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    if (new_index[i] != gone) left.push_back(std::move(document.json[name][i]));
  }
  if (left.empty()) {
    document.json.erase(name);
  } else {
    document.json[name] = std::move(left);
  }
}

std::size_t data_buffer_of(const Json& view) {
  if (const Json* extensions = find_member(view, "extensions")) {
    for (const auto* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
      if (const Json* packed = find_member(*extensions, name)) return index_member(*packed, "buffer").value_or(0);
    }
  }
  return index_member(view, "buffer").value_or(0);
}

/// Cuts the bytes of the removed views out; returns the buffers these views referred to.
std::set<std::size_t> cut_bytes(Document& document, const std::set<std::size_t>& removed) {
  const auto ranges = stored_ranges(document);
  std::set<std::size_t> touched;
  for (const auto& range : ranges) {
    if (removed.contains(range.view)) touched.insert(range.buffer);
  }
  for (const auto buffer : touched) {
    std::vector<const StoredRange*> inside;
    for (const auto& range : ranges) {
      if (range.buffer == buffer) inside.push_back(&range);
    }
    cut_buffer(document, buffer, inside, removed);
  }
  for (const auto view : removed) add_index(touched, &document.json["bufferViews"][view], "buffer");
  return touched;
}

}  // namespace

std::set<std::size_t> remove_unused(Document& document, const Candidates& candidates, Numbering numbering) {
  Json& json = document.json;
  const auto accessors = unused_of(candidates.accessors, used_objects(find_references(document), ObjectKind::accessor,
                                                                      array_size(json, "accessors")));
  std::set<std::size_t> view_candidates = candidates.buffer_views;
  for (const auto index : accessors) {
    add_views_of(json["accessors"][index], view_candidates);
    json["accessors"][index] = Json{{"componentType", 5121}, {"count", 1}, {"type", "SCALAR"}};
  }
  const auto views = unused_of(view_candidates, used_objects(find_references(document), ObjectKind::buffer_view,
                                                             array_size(json, "bufferViews")));
  const auto touched = views.empty() ? std::set<std::size_t>() : cut_bytes(document, views);
  for (const auto index : views) {
    Json& view = json["bufferViews"][index];
    view = Json{{"buffer", data_buffer_of(view)}, {"byteLength", 1}};
  }
  if (numbering == Numbering::may_change) {
    erase_and_renumber(document, ObjectKind::accessor, accessors);
    erase_and_renumber(document, ObjectKind::buffer_view, views);
  }
  return touched;
}

void drop_empty_buffers(Document& document, const std::set<std::size_t>& buffers, Numbering numbering) {
  const auto used = used_objects(find_references(document), ObjectKind::buffer, document.buffers.size());
  std::set<std::size_t> dropped;
  for (const auto buffer : buffers) {
    if (!document.buffers[buffer].empty()) continue;
    const bool is_bin_chunk = document.is_glb && buffer == 0 && document.buffers.size() > 1;
    if (numbering == Numbering::may_change && !used[buffer] && !is_bin_chunk) {
      dropped.insert(buffer);
    } else if (document.has_data[buffer]) {
      document.buffers[buffer].assign(4, 0);
      document.json["buffers"][buffer]["byteLength"] = 4;
    }
  }
  erase_and_renumber(document, ObjectKind::buffer, dropped);
  for (auto index = dropped.rbegin(); index != dropped.rend(); ++index) {
    document.buffers.erase(document.buffers.begin() + static_cast<std::ptrdiff_t>(*index));
    document.has_data.erase(document.has_data.begin() + static_cast<std::ptrdiff_t>(*index));
  }
}

}  // namespace nmc::gltf
