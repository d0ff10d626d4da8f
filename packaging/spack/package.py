"""A recipe for Spack. Not run: nobody has built vdwmesh by it yet."""

from spack.package import *


class Vdwmesh(CMakePackage):
    """Surfaces of molecules as triangle meshes, with proof of how good they are."""

    url = "https://example.invalid/vdwmesh-0.2.0.tar.gz"
    license("GPL-3.0-or-later")
    version("0.2.0", sha256="fill-in-the-hash-of-the-release")

    variant("mpi", default=True, description="The program for many processes")
    variant("python", default=True, description="The module for Python")
    variant("pictures", default=False, description="Pictures by OpenGL through EGL")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    for library in ("cgal@5.5:", "cli11@2.3:", "eigen@3.4:", "fmt@9:", "gemmi@0.5.7:", "gmp", "intel-oneapi-tbb",
                    "libarchive", "libdeflate", "mpfr", "msgpack-c", "nlohmann-json", "openmesh@9:", "pegtl",
                    "tinygltf", "zlib-api"):  # fmt: skip
        depends_on(library)
    with when("+mpi"):
        depends_on("mpi")
        depends_on("hdf5+mpi")
    with when("+python"):
        extends("python")
        depends_on("python@3.9:")
        depends_on("py-pybind11@2.10:", type="build")
        depends_on("py-numpy@1.21:", type="run")
    with when("+pictures"):
        depends_on("freetype")
        depends_on("libepoxy")
        depends_on("libpng")
    # Vega and three.js for the page of a study, as Debian has them.
    resource(name="javascript", url="https://example.invalid/vdwmesh-javascript-0.2.0.tar.gz",
             sha256="fill-in-the-hash-of-the-release", destination="", placement="javascript")  # fmt: skip

    conflicts("%gcc@:11", msg="needs C++20")

    def cmake_args(self):
        javascript = join_path(self.stage.source_path, "javascript")
        return [
            self.define("VDWMESH_CUDA", "OFF"),
            self.define("VDWMESH_BUILD_TESTS", False),
            self.define("VDWMESH_BUILD_BENCHMARKS", False),
            self.define("VDWMESH_VEGA_DIR", join_path(javascript, "vega")),
            self.define("VDWMESH_THREE_DIR", join_path(javascript, "three")),
            self.define_from_variant("VDWMESH_MPI", "mpi"),
            self.define_from_variant("VDWMESH_PYTHON", "python"),
            self.define_from_variant("VDWMESH_RENDER", "pictures"),
        ]
