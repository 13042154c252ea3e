// What a stream may be given: colours and lines that are drawn again, only where a person looks at a terminal.
#pragma once

#include <cstdio>
#include <string>

namespace nmc::cli {

/// A terminal that understands more than plain text (TERM is neither "dumb" nor missing).
bool is_terminal(std::FILE* stream);

/// is_terminal, and the environment has no NO_COLOR (https://no-color.org: any text but the empty one).
bool has_colours(std::FILE* stream);

/// Columns of the terminal, 80 where they are not known.
int terminal_width(std::FILE* stream);

/// A report's text for standard output: its first line bold, notes and animations that stay yellow, failures red. As it
/// is where standard output has no colours.
std::string coloured(const std::string& text);

}  // namespace nmc::cli
