#include "client/tool/output/vtk_file.h"

#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace latvox::client {
namespace {

constexpr uint64_t kBlock = PackedBlocks::kBlock;

// Returns everything before the appended data. The length does not depend on the offsets: spaces follow a short one,
// because meshio finds no array by an offset with leading zeros. It also expects no NumberOfComponents of 1.
//   offsets   of each array from the first byte of the data on
std::string Head(const VtkFile& vtk, const std::vector<uint64_t>& offsets) {
  std::string head = absl::StrCat("<?xml version=\"1.0\"?>\n<VTKFile type=\"", vtk.kind,
                                  "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
                                  "compressor=\"vtkZLibDataCompressor\">\n<",
                                  vtk.kind, vtk.attributes, ">\n<Piece", vtk.piece, ">\n");
  auto offset = offsets.begin();
  for (const VtkSection& section : vtk.sections) {
    absl::StrAppend(&head, "<", section.name, ">\n");
    for (const VtkArray& array : section.arrays) {
      const std::string components =
          array.components == 1 ? "" : absl::StrCat(" NumberOfComponents=\"", array.components, "\"");
      absl::StrAppendFormat(&head, "<DataArray type=\"%s\" Name=\"%s\"%s format=\"appended\" offset=%-22s/>\n",
                            array.type, array.name, components, absl::StrCat("\"", *offset++, "\""));
    }
    absl::StrAppend(&head, "</", section.name, ">\n");
  }
  return absl::StrCat(head, "</Piece>\n</", vtk.kind, ">\n<AppendedData encoding=\"raw\">\n_");
}

std::string_view BytesOfHead(const std::vector<uint64_t>& words) {
  return {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(words[0])};
}

// Appends an array: the number of blocks, the bytes of a block and of a shorter last one, the compressed bytes of each,
// and the blocks.
//   at   place in the file, which moves on
absl::Status Append(const VtkArray& array, AtomicFile& file, uint64_t& at) {
  const uint64_t blocks = (array.bytes + kBlock - 1) / kBlock;
  std::vector<uint64_t> head = {blocks, kBlock, array.bytes % kBlock};
  head.resize(3 + blocks);
  const uint64_t start = at;
  if (auto status = file.Append(BytesOfHead(head)); !status.ok()) return status;
  at += BytesOfHead(head).size();
  PackedBlocks packed(array.next, PackedBlocks::Form::kZlib);
  std::vector<PackedBlock> some;
  for (uint64_t n = 0; n < blocks;) {
    if (auto status = packed.Take(some); !status.ok()) {
      return absl::Status(status.code(), absl::StrCat(file.target(), ": ", status.message()));
    }
    for (const PackedBlock& block : some) {
      if (auto status = file.Append(block.bytes); !status.ok()) return status;
      at += head[3 + n++] = block.bytes.size();
    }
  }
  return file.Overwrite(start, BytesOfHead(head));
}

}  // namespace

const char* VtkTypeOf(NumberType type) {
  return type == NumberType::kUint8    ? "UInt8"
         : type == NumberType::kUint16 ? "UInt16"
         : type == NumberType::kUint32 ? "Int32"
                                       : "Float32";
}

absl::Status WriteVtkFile(const VtkFile& vtk, AtomicFile& file) {
  size_t arrays = 0;
  for (const VtkSection& section : vtk.sections) arrays += section.arrays.size();
  std::vector<uint64_t> offsets(arrays);
  const std::string head = Head(vtk, offsets);
  if (auto status = file.Append(head); !status.ok()) return status;
  uint64_t at = head.size();
  auto offset = offsets.begin();
  for (const VtkSection& section : vtk.sections) {
    for (const VtkArray& array : section.arrays) {
      *offset++ = at - head.size();
      if (auto status = Append(array, file, at); !status.ok()) return status;
    }
  }
  if (auto status = file.Append("\n</AppendedData>\n</VTKFile>\n"); !status.ok()) return status;
  return file.Overwrite(0, Head(vtk, offsets));
}

}  // namespace latvox::client
