// Reads the extension's content out of a document and checks it.
#include <limits>
#include <set>
#include <string>

#include "base/error.h"
#include "gltf/edit.h"
#include "gltf/edit_tools.h"
#include "gltf/json_text.h"
#include "gltf/json_tools.h"

namespace nmc::gltf {
namespace {

const Json* extension_of(const Json& object) {
  const Json* extensions = find_member(object, "extensions");
  return extensions ? find_member(*extensions, extension_name) : nullptr;
}

std::string extension_place(const std::string& object) { return object + "extensions." + extension_name; }

const Json& need_array(const Json& object, const char* key, const Where& where) {
  const Json* array = find_array(object, key, where);
  if (!array || array->empty()) where.fail(std::string("has no ") + key);
  return *array;
}

int need_int(const Json& object, const char* key, std::size_t count, const Where& where) {
  const Json* value = find_member(object, key);
  if (value && value->is_number_float()) where.fail(std::string("has a ") + key + " that is no integer");
  return static_cast<int>(get_index(object, key, count, where));
}

bool flag(const Json& object, const char* key, const Where& where) {
  const Json* value = find_member(object, key);
  if (!value) return false;
  if (!value->is_boolean()) where.fail(std::string("has a ") + key + " that is neither true nor false");
  return value->get<bool>();
}

bool is_listed(const Json& root, const char* list) {
  const Json* names = find_member(root, list);
  if (!names || !names->is_array()) return false;
  for (const auto& name : *names) {
    if (name == extension_name) return true;
  }
  return false;
}

Json extras_of(const Json& object) {
  const Json* extras = find_member(object, "extras");
  return extras ? *extras : Json();
}

constexpr auto most = static_cast<std::size_t>(std::numeric_limits<int>::max());

void check_version(const Json& extension, const Where& where) {
  const int version = need_int(extension, "version", most, where);
  if (version == 0) where.fail("has the version 0, which does not exist");
  if (version > 1) {
    throw Error(ErrorCode::unsupported, where.file_name + ": " + where.object + " has the version " +
                                            std::to_string(version) +
                                            "; this program reads version 1, use a newer one");
  }
}

/// A group of targets of one path: {"path": "rotation", "nodes": [0, 1, 4]}.
void read_targets(const Document& document, const Json& group, const Where& where, ClipSetBytes& clip_set,
                  std::set<Target>& seen) {
  if (!group.is_object()) where.fail("is no object");
  const auto name = find_string(group, "path", where);
  if (!name) where.fail("has no path");
  const auto path = path_from_name(*name);
  if (!path) where.fail("has the path \"" + *name + "\"; expected translation, rotation, scale or weights");
  const Json& nodes = need_array(group, "nodes", where);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto index = nodes[i].is_number_float() ? std::nullopt : as_index(nodes[i]);
    if (!index || *index >= std::min(most, array_size(document.json, "nodes")))
      where.at("nodes", i).fail("is no node of the file");
    const Target target{static_cast<int>(*index), *path};
    if (target.path == Path::weights && !find_member(document.json["nodes"][*index], "mesh"))
      where.at("nodes", i).fail("has no mesh whose morph weights could move");
    if (!seen.insert(target).second) where.at("nodes", i).fail("repeats a target of its clip set");
    clip_set.targets.push_back(target);
  }
}

ClipSetBytes read_clip_set(const Document& document, const Json& value, const Where& where) {
  if (!value.is_object()) where.fail("is no object");
  ClipSetBytes clip_set;
  const Json& targets = need_array(value, "targets", where);
  std::set<Target> seen;
  for (std::size_t i = 0; i < targets.size(); ++i)
    read_targets(document, targets[i], where.at("targets", i), clip_set, seen);
  const auto view = need_int(value, "bufferView", std::min(most, array_size(document.json, "bufferViews")), where);
  const auto stream = stored_view(document, static_cast<std::size_t>(view));
  clip_set.stream.assign(stream.begin(), stream.end());
  clip_set.extras = extras_of(value);
  return clip_set;
}

std::vector<ClipSetBytes> read_clip_sets(const Document& document, const Json& extension, const Where& where) {
  const Json& values = need_array(extension, "clipSets", where);
  std::vector<ClipSetBytes> clip_sets;
  std::set<std::size_t> views;
  std::size_t bytes_left = 0;
  for (const auto& buffer : document.buffers) bytes_left += buffer.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Where place = where.at("clipSets", i);
    if (const auto view = index_member(values[i], "bufferView"); view && !views.insert(*view).second) {
      place.fail("shares its bufferView with another clip set");
    }
    clip_sets.push_back(read_clip_set(document, values[i], place));
    const std::size_t size = clip_sets.back().stream.size();
    if (size > bytes_left) place.fail("has a stream that overlaps those of other clip sets");
    bytes_left -= size;
  }
  return clip_sets;
}

void check_shape(const Json& animation, const Where& where) {
  for (const auto* key : {"channels", "samplers"}) {
    const Json& objects = need_array(animation, key, where);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (!objects[i].is_object()) where.at(key, i).fail("is no object");
    }
  }
}

std::vector<CompressedAnimation> read_clips(const Document& document, std::size_t clip_sets) {
  std::vector<CompressedAnimation> clips;
  for (std::size_t i = 0; i < list_size(document.json, "animations", document.name); ++i) {
    const Json& animation = document.json["animations"][i];
    const Json* clip = extension_of(animation);
    if (!clip) continue;
    const Where owner{document.name, "animations[" + std::to_string(i) + "]"};
    const Where where{document.name, extension_place(owner.object + ".")};
    if (!clip->is_object()) where.fail("is no object");
    if (clip_sets == 0) where.fail("refers to a clip set, but the file has none");
    check_shape(animation, owner);
    flag(*clip, "stub", where);
    clips.push_back({static_cast<int>(i), need_int(*clip, "clipSet", clip_sets, where),
                     need_int(*clip, "clip", most, where), extras_of(*clip)});
  }
  return clips;
}

}  // namespace

CompressedContent read_compression(const Document& document) {
  CompressedContent content;
  const Json* extension = extension_of(document.json);
  if (!extension) {
    read_clips(document, 0);
    return content;
  }
  const Where where{document.name, extension_place("")};
  if (!extension->is_object()) where.fail("is no object");
  check_version(*extension, where);
  content.clip_sets = read_clip_sets(document, *extension, where);
  content.animations = read_clips(document, content.clip_sets.size());
  content.extras = extras_of(*extension);
  if (flag(*extension, "fallback", where)) {
    content.requirement = Requirement::fallback;
  } else if (!is_listed(document.json, "extensionsRequired")) {
    content.requirement = Requirement::optional;
  }
  return content;
}

}  // namespace nmc::gltf
