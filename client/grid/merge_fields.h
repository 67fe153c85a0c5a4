// Joins parts with fields, and bands. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_MERGE_FIELDS_H_
#define LATVOX_CLIENT_GRID_MERGE_FIELDS_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/grid/part_file.h"
#include "client/grid/part_metadata.h"
#include "latvox/cancellation.h"
#include "latvox/grid/merge.h"

namespace latvox::client {

// Writes the file of the whole. `progress` gets the number of parts read so far. Errors: those of MergeParts.
absl::StatusOr<MergedGrid> MergeFields(const std::vector<std::unique_ptr<PartFile>>& parts, const CommonFacts& common,
                                       const ReadPart& read, const std::string& path, const Cancellation& cancellation,
                                       const std::function<void(size_t)>& progress);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_MERGE_FIELDS_H_
