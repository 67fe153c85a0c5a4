// Outputs that list voxels one after the other: .csv, .npy, .ply.
#ifndef LATVOX_CLIENT_OUTPUT_TABLE_OUTPUT_H_
#define LATVOX_CLIENT_OUTPUT_TABLE_OUTPUT_H_

#include <memory>

#include "client/output/atomic_file.h"
#include "client/output/output.h"

namespace latvox::client {

// `distances`: of a band, whose batches have values.
std::unique_ptr<Output> NewCsvOutput(std::unique_ptr<AtomicFile> file, bool distances);
std::unique_ptr<Output> NewNpyOutput(std::unique_ptr<AtomicFile> file, bool distances);
std::unique_ptr<Output> NewPlyOutput(std::unique_ptr<AtomicFile> file, bool distances);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_OUTPUT_TABLE_OUTPUT_H_
