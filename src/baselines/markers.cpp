#include "baselines/markers.h"

#include <algorithm>
#include <cmath>

#include "motion/index.h"

namespace nmc::baselines {
namespace {

using motion::at;

constexpr double marker_distance = 0.08;  // of a marker beside a joint, share of size
constexpr double shortest_bone = 0.02;    // whose child can take a marker's place
constexpr double tiny = 1e-9;

std::vector<const Channel*> channels_by_node(const motion::Skeleton& skeleton, const Head& head, Path path) {
  std::vector<const Channel*> found(skeleton.size(), nullptr);
  for (const Channel& channel : head.channels)
    if (channel.moves && channel.target.path == path) found[at(channel.target.node)] = &channel;
  return found;
}

glm::dvec3 fixed_translation(const motion::Skeleton& skeleton, const Head& head, int node) {
  for (const Channel& channel : head.channels)
    if (!channel.moves && channel.target.node == node && channel.target.path == Path::translation)
      return {channel.value[0], channel.value[1], channel.value[2]};
  return skeleton.rest[at(node)].translation;
}

glm::dvec3 across(const glm::dvec3& direction) {
  glm::dvec3 axis(0.0);
  int least = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(direction[a]) < std::abs(direction[least])) least = a;
  axis[least] = 1;
  return glm::normalize(axis - direction * glm::dot(axis, direction));
}

void set_value(motion::Transform& local, Path path, const double* value) {
  if (path == Path::translation) local.translation = {value[0], value[1], value[2]};
  if (path == Path::scale) local.scale = {value[0], value[1], value[2]};
  if (path == Path::rotation) local.rotation = glm::normalize(glm::dquat(value[3], value[0], value[1], value[2]));
}

/// Rest transforms with the values of what does not move.
std::vector<motion::Transform> still_locals(const motion::Skeleton& skeleton, const Head& head) {
  std::vector<motion::Transform> locals = skeleton.rest;
  for (const Channel& channel : head.channels) {
    if (channel.moves || channel.target.path == Path::weights) continue;
    const std::vector<double> value(channel.value.begin(), channel.value.end());
    set_value(locals[at(channel.target.node)], channel.target.path, value.data());
  }
  return locals;
}

/// The exact rest matrix where nothing is animated: it may have no decomposition.
std::vector<char> animated_nodes(const motion::Skeleton& skeleton, const Head& head) {
  std::vector<char> animated(skeleton.size(), 0);
  for (const Channel& channel : head.channels)
    if (channel.target.path != Path::weights) animated[at(channel.target.node)] = 1;
  return animated;
}

glm::dmat4 below(const motion::Skeleton& skeleton, int node, const std::vector<glm::dmat4>& world) {
  const int parent = skeleton.parent[at(node)];
  return parent < 0 ? glm::dmat4(1.0) : world[at(parent)];
}

/// The rotation that takes the directions of `bone` and, around it, `side` to `to_bone` and `to_side`.
bool rotation_between(const glm::dvec3& bone, const glm::dvec3& side, const glm::dvec3& to_bone,
                      const glm::dvec3& to_side, glm::dquat& rotation) {
  const auto frame = [](const glm::dvec3& b, const glm::dvec3& s, glm::dmat3& made) {
    if (glm::length(b) < tiny) return false;
    const glm::dvec3 x = glm::normalize(b);
    const glm::dvec3 rest = s - x * glm::dot(s, x);
    if (glm::length(rest) < tiny) return false;
    const glm::dvec3 y = glm::normalize(rest);
    made = glm::dmat3(x, y, glm::cross(x, y));
    return true;
  };
  glm::dmat3 from, to;
  if (!frame(bone, side, from) || !frame(to_bone, to_side, to)) return false;
  rotation = glm::normalize(glm::quat_cast(to * glm::transpose(from)));
  return true;
}

}  // namespace

std::vector<motion::Transform> locals_of(const motion::Skeleton& skeleton, const Head& head,
                                         const Eigen::MatrixXd& values, Eigen::Index n) {
  std::vector<motion::Transform> locals = still_locals(skeleton, head);
  for (const Channel& channel : head.channels)
    if (channel.moves && channel.target.path != Path::weights)
      set_value(locals[at(channel.target.node)], channel.target.path, &values(channel.first, n));
  return locals;
}

std::vector<glm::dmat4> world_of(const motion::Skeleton& skeleton, const Head& head, const Eigen::MatrixXd& values,
                                 Eigen::Index n) {
  const std::vector<motion::Transform> locals = locals_of(skeleton, head, values, n);
  const std::vector<char> animated = animated_nodes(skeleton, head);
  std::vector<glm::dmat4> local(skeleton.size()), world(skeleton.size());
  for (std::size_t i = 0; i < local.size(); ++i)
    local[i] = animated[i] ? motion::to_matrix(locals[i]) : skeleton.rest_matrix[i];
  motion::world_matrices(skeleton, local, world);
  return world;
}

MarkerRig make_marker_rig(const motion::Skeleton& skeleton, const Head& head, MarkerSet set, double size) {
  MarkerRig rig;
  rig.skeleton = &skeleton;
  rig.head = &head;
  rig.size = size;
  rig.origin_marker.assign(skeleton.size(), -1);
  std::vector<glm::dmat4> world(skeleton.size());
  motion::world_matrices(skeleton, skeleton.rest_matrix, world);
  const auto add = [&](int node, const glm::dvec3& offset) {
    rig.markers.push_back({node, offset});
    return static_cast<int>(rig.markers.size()) - 1;
  };
  const auto origin = [&](int node) {
    int& marker = rig.origin_marker[at(node)];
    if (marker < 0) marker = add(node, glm::dvec3(0.0));
    return marker;
  };
  const auto turning = channels_by_node(skeleton, head, Path::rotation);
  const auto sliding = channels_by_node(skeleton, head, Path::translation);
  for (const int node : skeleton.order) {
    if (!turning[at(node)] && !sliding[at(node)]) continue;
    if (rig.root < 0) rig.root = node;
    origin(node);
    if (!turning[at(node)]) continue;
    const double scale = std::max(std::cbrt(std::abs(glm::determinant(glm::dmat3(world[at(node)])))), tiny);
    const double distance = marker_distance * size / scale;
    MarkedJoint joint;
    joint.node = node;
    joint.bone = {distance, 0, 0};
    double longest = shortest_bone * size / scale;
    int end = -1;
    for (int child = 0; child < static_cast<int>(skeleton.size()); ++child) {
      if (skeleton.parent[at(child)] != node || sliding[at(child)]) continue;
      const glm::dvec3 offset = fixed_translation(skeleton, head, child);
      if (glm::length(offset) <= longest) continue;
      longest = glm::length(offset);
      joint.bone = offset;
      end = child;
    }
    const glm::dvec3 direction = glm::normalize(joint.bone);
    if (set == MarkerSet::full) joint.bone = direction * distance;
    joint.side = across(direction) * distance;
    joint.bone_marker = set == MarkerSet::compact && end >= 0 ? origin(end) : add(node, joint.bone);
    joint.side_marker = add(node, joint.side);
    rig.joints.push_back(joint);
  }
  for (const Channel& channel : head.channels)
    if (channel.moves && (channel.target.path == Path::scale || channel.target.path == Path::weights))
      rig.extra_rows += channel.target.width;
  return rig;
}

Eigen::MatrixXd to_markers(const MarkerRig& rig, const Eigen::MatrixXd& values) {
  Eigen::MatrixXd markers(rig.rows(), values.cols());
  for (Eigen::Index n = 0; n < values.cols(); ++n) {
    const std::vector<glm::dmat4> world = world_of(*rig.skeleton, *rig.head, values, n);
    Eigen::Index row = 0;
    for (const Marker& marker : rig.markers) {
      const glm::dvec3 p(world[at(marker.node)] * glm::dvec4(marker.offset, 1.0));
      for (int a = 0; a < 3; ++a) markers(row++, n) = p[a];
    }
    for (const Channel& channel : rig.head->channels)
      if (channel.moves && (channel.target.path == Path::scale || channel.target.path == Path::weights))
        for (int a = 0; a < channel.target.width; ++a) markers(row++, n) = rig.size * values(channel.first + a, n);
  }
  return markers;
}

Eigen::MatrixXd from_markers(const MarkerRig& rig, const Eigen::MatrixXd& markers) {
  const motion::Skeleton& skeleton = *rig.skeleton;
  const Head& head = *rig.head;
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(head.rows(), markers.cols());
  Eigen::Index row = rig.marker_rows();
  for (const Channel& channel : head.channels)
    if (channel.moves && (channel.target.path == Path::scale || channel.target.path == Path::weights))
      for (int a = 0; a < channel.target.width; ++a) values.row(channel.first + a) = markers.row(row++) / rig.size;
  const auto turning = channels_by_node(skeleton, head, Path::rotation);
  const auto sliding = channels_by_node(skeleton, head, Path::translation);
  const auto scaling = channels_by_node(skeleton, head, Path::scale);
  std::vector<const MarkedJoint*> marked(skeleton.size(), nullptr);
  for (const MarkedJoint& joint : rig.joints) marked[at(joint.node)] = &joint;
  const std::vector<motion::Transform> still = still_locals(skeleton, head);
  const std::vector<char> animated = animated_nodes(skeleton, head);
  std::vector<glm::dmat4> world(skeleton.size());
  std::vector<glm::dquat> last(skeleton.size());
  for (std::size_t i = 0; i < last.size(); ++i) last[i] = still[i].rotation;
  const auto position = [&](int marker, Eigen::Index n) {
    return glm::dvec4(markers(3 * marker, n), markers(3 * marker + 1, n), markers(3 * marker + 2, n), 1.0);
  };
  for (Eigen::Index n = 0; n < markers.cols(); ++n) {
    for (const int node : skeleton.order) {
      const glm::dmat4 above = below(skeleton, node, world);
      if (!animated[at(node)]) {
        world[at(node)] = above * skeleton.rest_matrix[at(node)];
        continue;
      }
      motion::Transform local = still[at(node)];
      if (const Channel* c = scaling[at(node)])
        local.scale = {values(c->first, n), values(c->first + 1, n), values(c->first + 2, n)};
      const bool placed = sliding[at(node)] || turning[at(node)];
      const glm::dmat4 inverse =
          placed && std::abs(glm::determinant(above)) > 1e-18 ? glm::inverse(above) : glm::dmat4(1.0);
      if (const Channel* c = sliding[at(node)]) {
        local.translation = glm::dvec3(inverse * position(rig.origin_marker[at(node)], n));
        for (int a = 0; a < 3; ++a) values(c->first + a, n) = local.translation[a];
      }
      if (const Channel* c = turning[at(node)]) {
        const MarkedJoint& joint = *marked[at(node)];
        const glm::dvec3 to_bone = glm::dvec3(inverse * position(joint.bone_marker, n)) - local.translation;
        const glm::dvec3 to_side = glm::dvec3(inverse * position(joint.side_marker, n)) - local.translation;
        local.rotation = last[at(node)];
        rotation_between(local.scale * joint.bone, local.scale * joint.side, to_bone, to_side, local.rotation);
        if (glm::dot(local.rotation, last[at(node)]) < 0) local.rotation = -local.rotation;
        last[at(node)] = local.rotation;
        values(c->first, n) = local.rotation.x;
        values(c->first + 1, n) = local.rotation.y;
        values(c->first + 2, n) = local.rotation.z;
        values(c->first + 3, n) = local.rotation.w;
      }
      world[at(node)] = above * motion::to_matrix(local);
    }
  }
  return values;
}

}  // namespace nmc::baselines
