# Programs and library of a clone with the release's tag. The clone is HOMEBREW_LATVOX, because formulas lie in taps.
class Latvox < Formula
  desc "Exact voxels of triangle meshes on any lattice"
  url "file://#{ENV.fetch("HOMEBREW_LATVOX", "/usr/local/src/latvox")}", using: :git, tag: "v0.1.0"
  license "Apache-2.0"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "pkgconf" => :build
  depends_on "tomlplusplus" => :build
  depends_on "abseil"
  depends_on "boost"
  depends_on "c-blosc"
  depends_on "curl"
  depends_on "draco"
  depends_on "grpc"
  depends_on "hdf5"
  depends_on "highway"
  depends_on "jpeg-turbo"
  depends_on "libnghttp2"
  depends_on "libpng"
  depends_on "libseccomp"
  depends_on "libzip"
  depends_on :linux
  depends_on "meshoptimizer"
  # grpc and libzip link this OpenSSL and this zlib. Two versions of one library in a program clash.
  depends_on "openssl@4"
  depends_on "openvdb"
  depends_on "prometheus-cpp"
  depends_on "protobuf"
  depends_on "pugixml"
  depends_on "spdlog"
  depends_on "tbb"
  depends_on "webp"
  depends_on "xxhash"
  depends_on "zlib-ng-compat"
  depends_on "zstd"

  def install
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DBUILD_TESTING=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    (testpath/"mesh.obj").write "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    system bin/"latvox", "voxelize", "mesh.obj", "--resolution", "32", "-o", "mesh.vdb"
    assert_path_exists testpath/"mesh.vdb"
  end
end
