# A recipe for Homebrew on Linux. Not run: nobody has built vdwmesh by it yet.
class Vdwmesh < Formula
  desc "Surfaces of molecules as meshes, with proof of how good they are"
  homepage "https://example.invalid/vdwmesh"
  url "https://example.invalid/vdwmesh-0.2.0.tar.gz"
  sha256 "fill-in-the-hash-of-the-release"
  license "GPL-3.0-or-later"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "msgpack-cxx" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "pegtl" => :build
  depends_on "pkgconf" => :build
  depends_on "cgal"
  depends_on "eigen"
  depends_on "fmt"
  depends_on "gemmi"
  depends_on "gmp"
  depends_on "libarchive"
  depends_on "libdeflate"
  depends_on :linux
  depends_on "mpfr"
  depends_on "open-mesh"
  depends_on "tbb"
  depends_on "tinygltf"
  depends_on "zlib"

  # Vega and three.js for the page of a study, as Debian has them.
  resource "javascript" do
    url "https://example.invalid/vdwmesh-javascript-0.2.0.tar.gz"
    sha256 "fill-in-the-hash-of-the-release"
  end

  def install
    resource("javascript").stage(buildpath/"javascript")
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja",
           "-DVDWMESH_CUDA=OFF", "-DVDWMESH_MPI=OFF", "-DVDWMESH_RENDER=OFF", "-DVDWMESH_PYTHON=OFF",
           "-DVDWMESH_BUILD_TESTS=OFF", "-DVDWMESH_BUILD_BENCHMARKS=OFF",
           "-DVDWMESH_VEGA_DIR=#{buildpath}/javascript/vega",
           "-DVDWMESH_THREE_DIR=#{buildpath}/javascript/three", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build", "--component", "program"
  end

  test do
    assert_match "Topology", shell_output("#{bin}/vdwmesh report --sample bpti")
  end
end
