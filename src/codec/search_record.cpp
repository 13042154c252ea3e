#include "codec/search_record.h"

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "gltf/json_tools.h"

namespace nmc::codec {
namespace {

using gltf::Json;

auto order(const TriedKind& kind) { return std::tuple(!kind.within_bound, kind.bytes); }

template <class A, class B>
bool same_kind(const A& a, const B& b) {
  return a.basis == b.basis && a.jumps == b.jumps;
}

std::vector<TriedKind> kinds_of(const std::vector<Candidate>& candidates) {
  std::vector<TriedKind> kinds;
  for (const Candidate& candidate : candidates) {
    const TriedKind one{candidate.basis, candidate.jumps, candidate.bytes, candidate.kept};
    const auto same =
        std::find_if(kinds.begin(), kinds.end(), [&](const TriedKind& kind) { return same_kind(kind, one); });
    if (same == kinds.end())
      kinds.push_back(one);
    else if (order(one) < order(*same))
      *same = one;
  }
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const TriedKind& a, const TriedKind& b) { return order(a) < order(b); });
  // Of equal bytes those that were found first were taken.
  for (const Candidate& candidate : candidates)
    if (candidate.chosen)
      std::stable_partition(kinds.begin(), kinds.end(),
                            [&](const TriedKind& kind) { return same_kind(kind, candidate); });
  return kinds;
}

/// {"keys": 4032, "json": 800, "tried": [{"basis": "periodic", "jumps": true, "bytes": 452}, ...]}
Json search_json(const ClipResult& clip) {
  Json tried = Json::array();
  for (const TriedKind& kind : kinds_of(clip.candidates)) {
    tried.push_back(Json{{"basis", kind.basis}});
    if (kind.jumps) tried.back()["jumps"] = true;
    tried.back()["bytes"] = kind.bytes;
    if (!kind.within_bound) tried.back()["givenUp"] = true;
  }
  return Json{{"keys", clip.keys_before}, {"json", clip.json_before}, {"tried", std::move(tried)}};
}

/// {"poses": [{"coarser": 3, "bytes": 1130}, ...]}
Json poses_json(const std::vector<PoseRecord>& poses) {
  Json list = Json::array();
  for (const PoseRecord& pose : poses) {
    list.push_back(Json{{"coarser", pose.coarser}, {"bytes", pose.bytes}});
    if (!pose.within_bound) list.back()["givenUp"] = true;
  }
  return Json{{"poses", std::move(list)}};
}

std::size_t number(const Json& object, const char* key) { return gltf::index_member(object, key).value_or(0); }

std::string text(const Json& object, const char* key) {
  const Json* value = gltf::find_member(object, key);
  return value && value->is_string() ? value->get<std::string>() : std::string();
}

bool flag(const Json& object, const char* key) {
  const Json* value = gltf::find_member(object, key);
  return value && value->is_boolean() && value->get<bool>();
}

/// The objects of a list; nothing where there is no list.
std::vector<const Json*> objects_of(const Json& object, const char* key) {
  std::vector<const Json*> objects;
  const Json* list = gltf::find_member(object, key);
  if (!list || !list->is_array()) return objects;
  for (const Json& one : *list)
    if (one.is_object()) objects.push_back(&one);
  return objects;
}

}  // namespace

void put_search_records(const std::vector<ClipResult>& clips, const std::vector<EncodedSet>& sets,
                        gltf::CompressionEdit& edit) {
  for (gltf::TakenAnimation& taken : edit.taken)
    taken.extras = Json{{"search", search_json(clips[static_cast<std::size_t>(taken.animation)])}};
  for (std::size_t s = 0; s < sets.size(); ++s)
    if (!sets[s].poses.empty()) edit.clip_sets[s].extras = Json{{"search", poses_json(sets[s].poses)}};
  Json kept = Json::array();
  for (const ClipResult& clip : clips)
    if (clip.outcome != Outcome::compressed)
      kept.push_back(Json{{"animation", clip.animation}, {"reason", clip.reason}, {"search", search_json(clip)}});
  if (!kept.empty()) edit.extras = Json{{"kept", std::move(kept)}};
}

std::optional<SearchRecord> read_search(const Json& extras) {
  const Json* search = gltf::find_member(extras, "search");
  if (!search || !search->is_object()) return std::nullopt;
  SearchRecord record;
  record.key_bytes = number(*search, "keys");
  record.json_bytes = number(*search, "json");
  for (const Json* one : objects_of(*search, "tried"))
    record.tried.push_back({text(*one, "basis"), flag(*one, "jumps"), number(*one, "bytes"), !flag(*one, "givenUp")});
  return record;
}

std::vector<PoseRecord> read_poses(const Json& extras) {
  constexpr std::size_t coarsest = 100;
  std::vector<PoseRecord> poses;
  const Json* search = gltf::find_member(extras, "search");
  if (!search) return poses;
  for (const Json* one : objects_of(*search, "poses"))
    poses.push_back(
        {static_cast<int>(std::min(number(*one, "coarser"), coarsest)), number(*one, "bytes"), !flag(*one, "givenUp")});
  return poses;
}

std::vector<KeptRecord> read_kept(const Json& extras) {
  std::vector<KeptRecord> kept;
  for (const Json* one : objects_of(extras, "kept")) {
    const std::size_t animation = number(*one, "animation");
    if (animation > static_cast<std::size_t>(std::numeric_limits<int>::max())) continue;
    kept.push_back({static_cast<int>(animation), text(*one, "reason"), read_search(*one).value_or(SearchRecord{})});
  }
  return kept;
}

}  // namespace nmc::codec
