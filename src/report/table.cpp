#include "report/table.h"

#include <algorithm>
#include <stdexcept>

#include "report/format.h"

namespace nmc::report {
namespace {

constexpr std::size_t widest_cell = 40;
constexpr std::size_t widest_table = 100;
constexpr std::size_t gap = 2;
constexpr std::size_t readable_name = 20;  // a name is cut to this before a column goes,
constexpr std::size_t shortest_name = 12;  // and to this when none is left to go

std::string padded(const std::string& cell, std::size_t width, Align align) {
  const std::string blanks(width - display_width(cell), ' ');
  return align == Align::left ? cell + blanks : blanks + cell;
}

}  // namespace

void Table::add_row(std::vector<std::string> cells) {
  if (cells.size() > columns_.size()) throw std::logic_error("a table row has more cells than the table has columns");
  cells.resize(columns_.size());
  for (std::string& cell : cells) cell = shorten(printable(cell), widest_cell);
  rows_.push_back(std::move(cells));
}

Table::Layout Table::layout() const {
  Layout result;
  std::vector<std::size_t>& widths = result.widths;
  std::vector<std::size_t>& shown = result.shown;
  widths.assign(columns_.size(), 0);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    for (const auto& row : rows_) widths[c] = std::max(widths[c], display_width(row[c]));
    if (widths[c] == 0) continue;
    widths[c] = std::max(widths[c], display_width(columns_[c].title));
    shown.push_back(c);
  }
  const auto excess = [&] {
    std::size_t width = shown.empty() ? 0 : gap * (shown.size() - 1);
    for (const std::size_t c : shown) width += widths[c];
    return width > widest_table ? width - widest_table : 0;
  };
  // The widest name gives one column at a time.
  const auto cut_names = [&](std::size_t floor) {
    for (std::size_t left = excess(); left > 0; --left) {
      std::size_t widest = columns_.size();
      for (const std::size_t c : shown) {
        if (columns_[c].align == Align::left && widths[c] > std::max(floor, display_width(columns_[c].title)) &&
            (widest == columns_.size() || widths[c] > widths[widest]))
          widest = c;
      }
      if (widest == columns_.size()) return;
      --widths[widest];
    }
  };
  const auto most_expendable = [&] {
    return std::max_element(shown.begin(), shown.end(), [&](std::size_t a, std::size_t b) {
      return columns_[a].expendable < columns_[b].expendable;
    });
  };
  cut_names(readable_name);
  while (excess() > 0 && columns_[*most_expendable()].expendable > 0) shown.erase(most_expendable());
  cut_names(shortest_name);
  return result;
}

std::string Table::text() const {
  const Layout table = layout();
  const std::vector<std::size_t>& widths = table.widths;
  const auto line = [&](const auto& cell_of) {
    std::string out;
    for (const std::size_t c : table.shown) {
      if (!out.empty()) out += std::string(gap, ' ');
      out += padded(cell_of(c), widths[c], columns_[c].align);
    }
    out.erase(out.find_last_not_of(' ') + 1);
    return out + "\n";
  };
  const auto rule = [&] { return line([&](std::size_t c) { return std::string(widths[c], '-'); }); };

  std::string out = line([&](std::size_t c) { return columns_[c].title; }) + rule();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (std::find(rules_.begin(), rules_.end(), r) != rules_.end()) out += rule();
    out += line([&](std::size_t c) { return shorten(rows_[r][c], widths[c]); });
  }
  return out;
}

}  // namespace nmc::report
