// Eigenvalues of symmetric matrices; compiled once, for the solver takes long to compile.
#pragma once

#include <Eigen/Core>

namespace nmc {

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< rising; empty where a number is not finite
  Eigen::MatrixXd vectors;  ///< a column for each value, of length one, at right angles to each other
};

/// Of a symmetric matrix of any size; only its lower half is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

}  // namespace nmc
