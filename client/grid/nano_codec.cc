#include "client/grid/nano_codec.h"

#include <blosc.h>
#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

constexpr uint64_t kLeastLimit = uint64_t{1} << 29, kMostRatio = 32;
constexpr uint64_t kChunk = uint64_t{1} << 30;  // that BLOSC takes at once

// Reads a size and then so many bytes, of at most `left` bytes.
std::string ReadPacked(std::istream& in, uint64_t left) {
  uint64_t size = 0;
  if (left < sizeof(size)) throw std::runtime_error("a compressed grid is cut short");
  in.read(reinterpret_cast<char*>(&size), sizeof(size));
  if (size > left - sizeof(size)) throw std::runtime_error("a compressed grid is cut short");
  std::string packed(size, '\0');
  in.read(packed.data(), static_cast<std::streamsize>(size));
  return packed;
}

void Unzip(std::istream& in, uint64_t file_bytes, char* to, uint64_t bytes) {
  const std::string packed = ReadPacked(in, file_bytes);
  uLongf unpacked = bytes;
  const int status =
      uncompress(reinterpret_cast<Bytef*>(to), &unpacked, reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (status != Z_OK || unpacked != bytes) {
    throw std::runtime_error(absl::StrCat("its ZIP stream does not unpack to ", bytes, " bytes"));
  }
}

void Unblosc(std::istream& in, uint64_t file_bytes, char* to, uint64_t bytes) {
  for (uint64_t done = 0, read = 0; done < bytes;) {
    const std::string packed = ReadPacked(in, file_bytes - read);
    const auto chunk = static_cast<size_t>(std::min(bytes - done, kChunk));
    size_t unpacked = 0;
    if (blosc_cbuffer_validate(packed.data(), packed.size(), &unpacked) != 0 || unpacked != chunk ||
        blosc_decompress_ctx(packed.data(), to + done, chunk, /*numinternalthreads=*/1) != static_cast<int>(chunk)) {
      throw std::runtime_error(absl::StrCat("its BLOSC chunk at byte ", done, " does not unpack to ", chunk, " bytes"));
    }
    read += sizeof(uint64_t) + packed.size();
    done += chunk;
  }
}

}  // namespace

uint64_t MostUnpackedBytes(uint64_t file_bytes) { return std::max(kLeastLimit, kMostRatio * file_bytes); }

nanovdb::HostBuffer ReadNanoGrid(std::istream& in, const NanoFrameGrid& grid) {
  const uint64_t bytes = grid.header.gridSize, most = MostUnpackedBytes(grid.file_bytes);
  if (grid.is_compressed() && bytes > most) {
    throw std::runtime_error(
        absl::StrCat("its ", grid.file_bytes, " bytes are said to unpack to ", bytes, ", more than ", most));
  }
  auto buffer = nanovdb::HostBuffer::create(bytes);
  auto* const to = reinterpret_cast<char*>(buffer.data());
  in.seekg(static_cast<std::streamoff>(grid.at));
  switch (grid.header.codec) {
    case nanovdb::io::Codec::ZIP:
      Unzip(in, grid.file_bytes, to, bytes);
      break;
    case nanovdb::io::Codec::BLOSC:
      Unblosc(in, grid.file_bytes, to, bytes);
      break;
    default:
      in.read(to, static_cast<std::streamsize>(bytes));
  }
  return buffer;
}

}  // namespace latvox::client
