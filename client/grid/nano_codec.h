// Reads the bytes of a grid of a .nvdb file, compressed or not. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_CODEC_H_
#define LATVOX_CLIENT_GRID_NANO_CODEC_H_

#include <cstdint>
#include <istream>

#include "client/grid/nano_frame.h"

namespace latvox::client {

// The most bytes that a compressed grid of so many bytes may unpack to: 32 times as many, or 512 MiB if that is more.
uint64_t MostUnpackedBytes(uint64_t file_bytes);

// Returns the bytes of a grid, header.gridSize of them. NanoVDB's codecs are ZIP, one stream of zlib, and BLOSC, chunks
// of 1 GiB. Memory: these bytes, and those of the file. Starts no thread. Throws std::runtime_error: a grid beyond
// MostUnpackedBytes; bytes that do not unpack to a grid of this size; std::bad_alloc; and what `in` throws at its end.
nanovdb::HostBuffer ReadNanoGrid(std::istream& in, const NanoFrameGrid& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_CODEC_H_
