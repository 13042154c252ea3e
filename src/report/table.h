// A table of text with aligned columns.
#pragma once

#include <string>
#include <vector>

namespace nmc::report {

enum class Align { left, right };

struct Column {
  std::string title;
  Align align = Align::right;
  int expendable = 0;  ///< above 0: left out where the table is too wide, the highest first
};

/// Rows of cells under titles. Cells are made printable and cut to 40 columns; a column whose cells are all empty is
/// left out. A table fits 100 columns of a terminal: the cells of left-aligned columns (names) are shortened and
/// expendable columns are left out.
class Table {
 public:
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// One row; missing cells are empty, cells beyond the columns are a defect.
  void add_row(std::vector<std::string> cells);

  /// A rule between the rows above and below.
  void add_rule() { rules_.push_back(rows_.size()); }

  /// Lines that end in a newline, without trailing blanks.
  std::string text() const;

 private:
  struct Layout {
    std::vector<std::size_t> shown;   ///< columns
    std::vector<std::size_t> widths;  ///< by column
  };
  Layout layout() const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> rules_;
};

}  // namespace nmc::report
