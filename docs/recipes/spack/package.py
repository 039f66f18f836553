"""karamelo-rs for Spack: put this file into packages/karamelo_rs of a repository of yours."""

from spack.package import *
from spack_repo.builtin.build_systems.cargo import CargoPackage


class KarameloRs(CargoPackage):
    """Material point method simulator driven by Karamelo-style scripts."""

    # Where your copy of the repository is; a branch, since there are no releases yet.
    git = "file:///path/to/karamelo-rs"

    license("MIT OR Apache-2.0")

    version("main", branch="main")

    variant("mpi", default=False, description="Several processes under mpirun")

    depends_on("c", type="build")
    depends_on("rust@1.88:", type="build")
    depends_on("mpi", when="+mpi")
    depends_on("llvm+clang", type="build", when="+mpi")

    @property
    def build_args(self):
        args = ["--locked"]
        if self.spec.satisfies("+mpi"):
            args += ["--features", "mpi"]
        return args

    def setup_build_environment(self, env):
        if self.spec.satisfies("+mpi"):
            env.set("LIBCLANG_PATH", self.spec["llvm"].prefix.lib)
