// What putting the extension into a document and taking it out have in common.
#pragma once

#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "gltf/compact.h"
#include "gltf/document.h"
#include "gltf/edit.h"

namespace nmc::gltf {

/// The glTF name of a path ("translation", "rotation", "scale", "weights") and back.
const char* path_name(Path path);
std::optional<Path> path_from_name(std::string_view name);

/// The node property that a channel moves; nothing for channels without node or with another path.
std::optional<Target> channel_target(const Json& channel);

/// Takes channels out of an animation, and the samplers that no channel is left to use; what those samplers referred to
/// is added to `candidates`. With numbering kept, unused samplers stay without input and output until
/// fill_unused_samplers.
void remove_channels(Json& animation, const std::set<std::size_t>& channels, Numbering numbering,
                     Candidates& candidates);

/// Lets samplers that remove_channels left empty refer to what the animation's first channel uses, so that they are
/// valid.
void fill_unused_samplers(Json& animation);

/// Takes `key` out of an object's extensions, and the extensions out of the object where none is left.
void erase_extension(Json& object, const char* key);

/// Lists or unlists a name in the root array `list` ("extensionsUsed", "extensionsRequired").
void list_extension(Json& root, const char* list, const char* name);
void unlist_extension(Json& root, const char* list, const char* name);

}  // namespace nmc::gltf
