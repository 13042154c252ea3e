// The table of docs/compatibility.md: what becomes of each feature, found by doing it.
#pragma once

#include <string>

#include "corpus/features.h"

namespace nmc::test {

/// What compressing the feature's file comes to, in the words of the table.
std::string treatment(const Feature& feature);

/// The whole page.
std::string compatibility_page();

}  // namespace nmc::test
