#include "baselines/pose_matrix.h"

#include "motion/index.h"

namespace nmc::baselines {
namespace {

using motion::at;
using motion::Form;

int width_of(const Channel& channel, Form form) { return form == Form::axis_angle ? 3 : channel.target.width; }

motion::Block block_of(const motion::Skeleton& skeleton, const Channel& channel, Form form) {
  motion::Block block;
  block.form = form;
  block.width = width_of(channel, form);
  if (form == Form::axis_angle) block.reference = skeleton.rest[at(channel.target.node)].rotation;
  return block;
}

motion::Track track_of(const Channel& channel, const Eigen::MatrixXd& values) {
  motion::Track track{channel.target.node, channel.target.path, channel.target.width, {}};
  for (Eigen::Index n = 0; n < values.cols(); ++n)
    for (int a = 0; a < track.width; ++a) track.values.push_back(static_cast<float>(values(channel.first + a, n)));
  return track;
}

bool is_root(const motion::Skeleton& skeleton, const Head& head, int node) {
  for (int above = skeleton.parent[at(node)]; above >= 0; above = skeleton.parent[at(above)])
    for (const Channel& channel : head.channels)
      if (channel.moves && channel.target.path == Path::rotation && channel.target.node == above) return false;
  return true;
}

double largest_angle(const motion::Skeleton& skeleton, const Channel& channel, const Eigen::MatrixXd& values) {
  const glm::dquat rest = skeleton.rest[at(channel.target.node)].rotation;
  const Eigen::Vector4d r(rest.x, rest.y, rest.z, rest.w);
  double least = 1;
  for (Eigen::Index n = 0; n < values.cols(); ++n)
    least = std::min(least, std::abs(r.dot(values.block<4, 1>(channel.first, n))));
  return 2 * std::acos(std::min(1.0, least));
}

template <typename Use>
void for_moving(const Head& head, const PoseForms& forms, const Use& use) {
  std::size_t i = 0;
  int first = 0;
  for (const Channel& channel : head.channels) {
    if (!channel.moves) continue;
    use(channel, forms.forms[i], first);
    first += width_of(channel, forms.forms[i]);
    ++i;
  }
}

}  // namespace

PoseForms pose_forms(const motion::Skeleton& skeleton, const Head& head, const Eigen::MatrixXd& values) {
  PoseForms forms;
  for (const Channel& channel : head.channels) {
    if (!channel.moves) continue;
    Form form = Form::vector;
    if (channel.target.path == Path::rotation)
      form = is_root(skeleton, head, channel.target.node) ||
                     largest_angle(skeleton, channel, values) > motion::axis_angle_limit_radians
                 ? Form::quaternion
                 : Form::axis_angle;
    forms.forms.push_back(form);
    forms.rows += width_of(channel, form);
  }
  return forms;
}

Eigen::MatrixXd to_pose_matrix(const motion::Skeleton& skeleton, const Head& head, const PoseForms& forms,
                               const Eigen::MatrixXd& values) {
  Eigen::MatrixXd poses(forms.rows, values.cols());
  for_moving(head, forms, [&](const Channel& channel, Form form, int first) {
    motion::Block block = block_of(skeleton, channel, form);
    const std::vector<double> made = motion::to_parameters(track_of(channel, values), block);
    for (Eigen::Index n = 0; n < values.cols(); ++n)
      for (int a = 0; a < block.width; ++a) {
        const bool one_row = made.size() == at(block.width);
        poses(first + a, n) = made[static_cast<std::size_t>((one_row ? 0 : n * block.width) + a)];
      }
  });
  return poses;
}

Eigen::MatrixXd from_pose_matrix(const motion::Skeleton& skeleton, const Head& head, const PoseForms& forms,
                                 const Eigen::MatrixXd& poses) {
  Eigen::MatrixXd values(head.rows(), poses.cols());
  for_moving(head, forms, [&](const Channel& channel, Form form, int first) {
    const motion::Block block = block_of(skeleton, channel, form);
    std::vector<double> rows;
    for (Eigen::Index n = 0; n < poses.cols(); ++n)
      for (int a = 0; a < block.width; ++a) rows.push_back(poses(first + a, n));
    const std::vector<float> made = motion::from_parameters(rows, block, channel.target.path);
    for (Eigen::Index n = 0; n < poses.cols(); ++n)
      for (int a = 0; a < channel.target.width; ++a)
        values(channel.first + a, n) = made[static_cast<std::size_t>(n * channel.target.width + a)];
  });
  return values;
}

void write_forms(ByteWriter& bytes, const PoseForms& forms) {
  for (const Form form : forms.forms) bytes.u8(static_cast<unsigned>(form));
}

PoseForms read_forms(ByteReader& bytes, const Head& head) {
  PoseForms forms;
  for (const Channel& channel : head.channels) {
    if (!channel.moves) continue;
    const unsigned form = bytes.u8();
    if (form > 2 || (form == 0) != (channel.target.path != Path::rotation)) refuse_damaged("a form is unknown");
    forms.forms.push_back(static_cast<Form>(form));
    forms.rows += width_of(channel, forms.forms.back());
  }
  return forms;
}

}  // namespace nmc::baselines
