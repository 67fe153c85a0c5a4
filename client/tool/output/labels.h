// The labels of a labeled set in a file, and their fractions.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_LABELS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_LABELS_H_

#include <cstdint>
#include <span>
#include <string>

#include "latvox/grid/grid_content.h"

namespace latvox::client {

// Returns the field whose numbers are the labels: materials if the file's request says so, otherwise parts.
Field FieldOfLabels(const GridFileInfo& info);

// Returns the name of a label in the mesh's file, or "".
std::string NameOfLabel(const GridFileInfo& info, uint32_t label);

// Returns Field::kFraction of these labels together.
//   fractions   of Field::kLabelFractions
FieldValues FractionOf(const FieldValues& fractions, std::span<const uint32_t> labels);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_LABELS_H_
