#include "client/grid/nano_frame.h"

#include <stdexcept>

#include "absl/strings/str_cat.h"
#include "client/grid/nano_facts.h"

namespace latvox::client {
namespace {

[[noreturn]] void Fail(const std::string& why) { throw std::runtime_error(why); }

template <class T>
T Get(std::istream& in) {
  T value;
  in.read(reinterpret_cast<char*>(&value), sizeof(value));
  return value;
}

NanoFileHeader ReadHeader(std::istream& in) {
  const auto header = Get<NanoFileHeader>(in);
  if (!IsNanoMagic(header.magic)) Fail("it goes on with something else");
  const uint32_t version = header.version.getMajor();
  if (version != NANOVDB_MAJOR_VERSION_NUMBER) {
    Fail(absl::StrCat("it has version ", version, " of the format, not ", NANOVDB_MAJOR_VERSION_NUMBER));
  }
  return header;
}

NanoFrameGrid ReadGridHeader(std::istream& in) {
  NanoFrameGrid grid{{}, Get<NanoMetaData>(in)};
  const NanoMetaData& header = grid.header;
  if (header.codec > nanovdb::io::Codec::BLOSC) {
    Fail(absl::StrCat("its codec is ", static_cast<int>(header.codec), ", neither 0, 1 (ZIP) nor 2 (BLOSC)"));
  }
  if (header.nameSize > kMostNanoText) {
    Fail(absl::StrCat("the name of a grid has ", header.nameSize, " bytes, more than ", kMostNanoText));
  }
  std::string name(header.nameSize, '\0');
  in.read(name.data(), static_cast<std::streamsize>(name.size()));
  grid.name = name.c_str();  // a 0 ends it
  grid.file_bytes = grid.is_compressed() ? header.fileSize : header.gridSize;
  if (header.gridSize < sizeof(nanovdb::GridData)) Fail("a grid is smaller than its header");
  return grid;
}

}  // namespace

// The file is a sequence of segments: a header, the headers of its grids, and these.
std::vector<NanoFrameGrid> ReadNanoFrame(std::istream& in) {
  in.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  in.seekg(0, std::ios::end);
  const auto size = static_cast<uint64_t>(in.tellg());
  std::vector<NanoFrameGrid> grids;
  for (uint64_t at = 0; at < size;) {
    in.seekg(static_cast<std::streamoff>(at));
    const size_t first = grids.size();
    for (uint32_t left = ReadHeader(in).gridCount; left > 0; --left) grids.push_back(ReadGridHeader(in));
    at = static_cast<uint64_t>(in.tellg());
    for (size_t n = first; n < grids.size(); ++n) {
      if (grids[n].file_bytes > size - at) Fail("it is cut short");
      grids[n].at = at;
      at += grids[n].file_bytes;
    }
  }
  if (grids.empty()) Fail("it has no grid");
  return grids;
}

void CheckNanoData(const NanoFrameGrid& grid, const nanovdb::GridData& data) {
  if (!IsNanoMagic(data.mMagic)) Fail("it has no grid behind its header");
  if (data.mGridSize > grid.header.gridSize) Fail("it is cut short");
}

nanovdb::GridData ReadNanoData(std::istream& in, const NanoFrameGrid& grid) {
  in.seekg(static_cast<std::streamoff>(grid.at));
  const auto data = Get<nanovdb::GridData>(in);
  CheckNanoData(grid, data);
  return data;
}

std::vector<std::pair<std::string, std::string>> ReadNanoMetadata(std::istream& in, const NanoFrameGrid& grid,
                                                                  const nanovdb::GridData& data) {
  return NanoMetadata(data, [&](uint64_t at, void* to, uint64_t bytes) {
    if (at > grid.file_bytes || bytes > grid.file_bytes - at) return false;
    in.seekg(static_cast<std::streamoff>(grid.at + at));
    in.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes));
    return true;
  });
}

}  // namespace latvox::client
