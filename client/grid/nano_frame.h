// The headers of a .nvdb file, which say what its grids are and where they lie. Includes NanoVDB's headers, but none of
// OpenVDB. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_FRAME_H_
#define LATVOX_CLIENT_GRID_NANO_FRAME_H_

#include <cstdint>
#include <istream>
#include <string>
#include <utility>
#include <vector>

#include "client/grid/nano_names.h"

namespace latvox::client {

struct NanoFrameGrid {
  std::string name;
  NanoMetaData header;              // gridSize is the size without compression
  uint64_t at = 0, file_bytes = 0;  // its place in the file

  bool is_compressed() const { return header.codec != nanovdb::io::Codec::NONE; }
};

// These functions throw std::runtime_error with the reason, and std::ios_base::failure at the end of the file. They
// check each length and place before they use it.

// Reads the headers of all grids; there is at least one. Each grid lies within the file, and is not smaller than
// nanovdb::GridData.
std::vector<NanoFrameGrid> ReadNanoFrame(std::istream& in);

// Throws unless these are data of a grid with this header.
void CheckNanoData(const NanoFrameGrid& grid, const nanovdb::GridData& data);

// Read the front of a grid, and the metadata that WriteNanoFile writes. Precondition: it is not compressed.
nanovdb::GridData ReadNanoData(std::istream& in, const NanoFrameGrid& grid);
std::vector<std::pair<std::string, std::string>> ReadNanoMetadata(std::istream& in, const NanoFrameGrid& grid,
                                                                  const nanovdb::GridData& data);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_FRAME_H_
