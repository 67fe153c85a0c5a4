// The frame of a .vdb file, read without OpenVDB: names, metadata and places of its grids. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_FRAME_H_
#define LATVOX_CLIENT_GRID_GRID_FRAME_H_

#include <cstdint>
#include <istream>
#include <string>
#include <vector>

namespace latvox::client {

// OpenVDB's functions trust the lengths in a file: a damaged one makes them take gigabytes of memory, or crash. This
// reader checks each length against the file's size before it uses it.
//
// The layout, of format version 224:
//
//   header     magic number, 8 bytes; format version, library's major and minor, 32 bits each; a byte: 1 if the places
//              of grids follow; UUID, 36 bytes
//   metadata   count; for each: name, type, size of the value, the value
//   grids      count; for each: a descriptor (name, type, name of the grid that has its tree, three places), and at the
//              first place compression, metadata and transform
//
// Counts and sizes have 32 bits, places 64. A text has its size first.
inline constexpr int64_t kVdbMagic = 0x56444220;
inline constexpr char kDelayedLoadType[] = "__delayedload";  // of metadata about places in the file

struct FrameMetadata {
  std::string name, type, value;  // the value's bytes
};
struct FrameGrid {
  std::string name, type;  // the name as OpenVDB writes it: with a suffix where two grids have the same
  std::string transform;   // its type
  uint64_t transform_at;   // place of the transform in the file
  std::vector<FrameMetadata> metadata;
};
struct GridFrame {
  std::vector<FrameGrid> grids;  // in the order of the file
};

// Reads the frame from the front of `in`, a file of `size` bytes; the place in `in` is then anywhere. Memory: a few
// times that of the metadata. Throws std::runtime_error with the reason:
//   - not a .vdb file, of another format version than this OpenVDB writes, written as a stream, or cut short
//   - metadata of a type that files of latvox do not have
//   - metadata with a value that their type does not have
//   - metadata that reach into the tree of their grid, or beyond
GridFrame ReadGridFrame(std::istream& in, uint64_t size);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_FRAME_H_
