#include "baselines/contacts.h"

#include <algorithm>
#include <cmath>

#include "baselines/inverse_kinematics.h"
#include "baselines/markers.h"
#include "motion/index.h"

namespace nmc::baselines {
namespace {

using Eigen::Index;
using motion::at;

constexpr double floor_range = 0.02;      // of a joint in contact above or below the floor, share of size
constexpr double most_way = 0.025 / 1.6;  // between two frames, share of size: 2.5 cm of a person
constexpr int chain = 3;                  // joints that turn: toes to hip
constexpr double reached = 1e-4;          // share of size

/// Joints below which something with a rotation that moves exists above: what can be put right.
std::vector<int> reaching_joints(const motion::Skeleton& skeleton, const Head& head) {
  std::vector<char> turns(skeleton.size(), 0);
  for (const Channel& channel : head.channels)
    if (channel.moves && channel.target.path == Path::rotation) turns[at(channel.target.node)] = 1;
  std::vector<int> joints;
  for (const int node : skeleton.joints.empty() ? skeleton.order : skeleton.joints) {
    const int parent = skeleton.parent[at(node)];
    if (parent >= 0 && turns[at(parent)]) joints.push_back(node);
  }
  return joints;
}

/// Positions of joints: 3 joints x samples.
Eigen::MatrixXd joint_positions(const motion::Skeleton& skeleton, const Head& head, const std::vector<int>& joints,
                                const Eigen::MatrixXd& values) {
  Eigen::MatrixXd positions(3 * static_cast<Index>(joints.size()), values.cols());
  for (Index n = 0; n < values.cols(); ++n) {
    const std::vector<glm::dmat4> world = world_of(skeleton, head, values, n);
    for (std::size_t j = 0; j < joints.size(); ++j)
      for (int a = 0; a < 3; ++a) positions(3 * static_cast<Index>(j) + a, n) = world[at(joints[j])][3][a];
  }
  return positions;
}

/// The mean of the lowest of four clusters of heights (k-means from even quantiles).
double floor_height(const std::vector<Eigen::MatrixXd>& positions) {
  std::vector<double> heights;
  for (const Eigen::MatrixXd& p : positions)
    for (Index n = 0; n < p.cols(); ++n)
      for (Index row = 1; row < p.rows(); row += 3) heights.push_back(p(row, n));
  if (heights.empty()) return 0;
  std::sort(heights.begin(), heights.end());
  constexpr std::size_t clusters = 4;
  double centers[clusters];
  for (std::size_t c = 0; c < clusters; ++c) centers[c] = heights[heights.size() * (2 * c + 1) / (2 * clusters)];
  for (int round = 0; round < 20; ++round) {
    double sums[clusters] = {}, counts[clusters] = {};
    for (const double h : heights) {
      std::size_t nearest = 0;
      for (std::size_t c = 1; c < clusters; ++c)
        if (std::abs(h - centers[c]) < std::abs(h - centers[nearest])) nearest = c;
      sums[nearest] += h;
      ++counts[nearest];
    }
    for (std::size_t c = 0; c < clusters; ++c)
      if (counts[c] > 0) centers[c] = sums[c] / counts[c];
  }
  return centers[0];
}

struct Contact {
  std::size_t clip = 0, joint = 0;
  Index first = 0;
  std::vector<Eigen::Vector3d> way;  ///< wanted positions
};

std::vector<Contact> find_contacts(const std::vector<Eigen::MatrixXd>& positions, double size, double step) {
  std::vector<Contact> contacts;
  const double height = floor_height(positions);
  const double most = std::min(most_way * size, 7 * step);
  for (std::size_t clip = 0; clip < positions.size(); ++clip) {
    const Eigen::MatrixXd& p = positions[clip];
    for (Index joint = 0; 3 * joint < p.rows(); ++joint) {
      bool open = false;
      for (Index n = 0; n < p.cols(); ++n) {
        const Eigen::Vector3d now = p.block<3, 1>(3 * joint, n);
        const bool near = std::abs(now.y() - height) <= floor_range * size;
        if (open && (!near || (now - contacts.back().way.back()).cwiseAbs().maxCoeff() > most)) open = false;
        if (near && !open) contacts.push_back({clip, static_cast<std::size_t>(joint), n, {}});
        open = near;
        if (open) contacts.back().way.push_back(now);
      }
    }
  }
  std::erase_if(contacts, [](const Contact& c) { return c.way.size() < 4; });
  return contacts;
}

void move_joints(const motion::Skeleton& skeleton, const Head& head, const std::vector<int>& joints,
                 const std::vector<Contact>& contacts, std::vector<Eigen::MatrixXd>& clips, double size) {
  // Feet before toes: joints are in the order of the skeleton.
  std::vector<std::vector<std::vector<std::pair<int, Eigen::Vector3d>>>> targets(clips.size());
  for (std::size_t c = 0; c < clips.size(); ++c) targets[c].resize(static_cast<std::size_t>(clips[c].cols()));
  for (const Contact& contact : contacts)
    for (std::size_t i = 0; i < contact.way.size(); ++i)
      targets[contact.clip][static_cast<std::size_t>(contact.first) + i].push_back(
          {joints[contact.joint], contact.way[i]});
  std::vector<std::size_t> rank(skeleton.size());
  for (std::size_t i = 0; i < skeleton.order.size(); ++i) rank[at(skeleton.order[i])] = i;
  for (std::size_t c = 0; c < clips.size(); ++c)
    for (std::size_t n = 0; n < targets[c].size(); ++n) {
      auto& frame = targets[c][n];
      if (frame.empty()) continue;
      std::stable_sort(frame.begin(), frame.end(),
                       [&](const auto& a, const auto& b) { return rank[at(a.first)] < rank[at(b.first)]; });
      ReachingPose pose(skeleton, head, clips[c], static_cast<Index>(n));
      for (const auto& [joint, target] : frame)
        pose.reach(joint, {target.x(), target.y(), target.z()}, chain, reached * size);
    }
}

}  // namespace

void write_contacts(ByteWriter& bytes, const motion::Skeleton& skeleton, const Head& head,
                    const std::vector<Eigen::MatrixXd>& wanted, const std::vector<Eigen::MatrixXd>& decoded,
                    double size, double step) {
  const std::vector<int> joints = reaching_joints(skeleton, head);
  std::vector<Eigen::MatrixXd> positions;
  for (const Eigen::MatrixXd& values : wanted) positions.push_back(joint_positions(skeleton, head, joints, values));
  const std::vector<Contact> contacts = find_contacts(positions, size, step);
  double largest = 1e-9;
  std::vector<Eigen::Vector3d> starts;
  for (const Contact& contact : contacts) {
    Eigen::MatrixXd one = decoded[contact.clip].col(contact.first);
    const Eigen::MatrixXd p = joint_positions(skeleton, head, {joints[contact.joint]}, one);
    starts.push_back(p.col(0));
    largest = std::max(largest, (contact.way.front() - starts.back()).cwiseAbs().maxCoeff());
  }
  const auto start_step = static_cast<double>(static_cast<float>(largest / 127));
  const auto way_step = static_cast<double>(static_cast<float>(step));
  ByteWriter places, first, ways;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& contact = contacts[i];
    places.count(contact.clip);
    places.count(contact.joint);
    places.count(static_cast<std::uint64_t>(contact.first));
    places.count(contact.way.size());
    Eigen::Vector3d at_now = starts[i];
    for (std::size_t n = 0; n < contact.way.size(); ++n)
      for (Index a = 0; a < 3; ++a) {
        const double by = n == 0 ? start_step : way_step;
        const double most = n == 0 ? 127 : 7;
        const double level = std::clamp(std::round((contact.way[n](a) - at_now(a)) / by), -most, most);
        at_now(a) += level * by;
        (n == 0 ? first : ways).u8(static_cast<unsigned>(level + 128));
      }
  }
  bytes.count(contacts.size());
  bytes.f32(size);
  bytes.f32(start_step);
  bytes.f32(way_step);
  bytes.packed(places.bytes());
  bytes.packed(first.bytes());
  bytes.packed(ways.bytes());
}

void apply_contacts(ByteReader& bytes, const motion::Skeleton& skeleton, const Head& head,
                    std::vector<Eigen::MatrixXd>& decoded) {
  const std::vector<int> joints = reaching_joints(skeleton, head);
  const std::uint64_t count = bytes.count(std::uint64_t{1} << 24);
  const double size = bytes.f32(), start_step = bytes.f32(), way_step = bytes.f32();
  const Bytes place_bytes = bytes.packed(), first_bytes = bytes.packed(), way_bytes = bytes.packed();
  ByteReader places(place_bytes), first(first_bytes), ways(way_bytes);
  std::vector<Contact> contacts;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (joints.empty() || decoded.empty()) refuse_damaged("no joint can be in contact");
    Contact contact;
    contact.clip = static_cast<std::size_t>(places.count(decoded.size() - 1));
    contact.joint = static_cast<std::size_t>(places.count(joints.size() - 1));
    const auto frames = static_cast<std::uint64_t>(decoded[contact.clip].cols());
    contact.first = static_cast<Index>(places.count(frames - 1));
    const std::uint64_t length = places.count(frames - static_cast<std::uint64_t>(contact.first));
    const Eigen::MatrixXd one = decoded[contact.clip].col(contact.first);
    Eigen::Vector3d now = joint_positions(skeleton, head, {joints[contact.joint]}, one).col(0);
    for (std::uint64_t n = 0; n < length; ++n) {
      for (Index a = 0; a < 3; ++a)
        now(a) += (n == 0 ? start_step : way_step) * (static_cast<double>((n == 0 ? first : ways).u8()) - 128);
      contact.way.push_back(now);
    }
    contacts.push_back(std::move(contact));
  }
  places.expect_end();
  first.expect_end();
  ways.expect_end();
  move_joints(skeleton, head, joints, contacts, decoded, size);
}

}  // namespace nmc::baselines
