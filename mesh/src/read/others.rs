//! Formats of meshes that are not read, and what converts them.

/// Endings of files, and what to do.
const CONVERTERS: [(&str, &str); 14] = [
    (
        "step stp iges igs brep",
        "mesh it with Gmsh: `gmsh -3 FILE -o NEW.msh` for cells, `gmsh -2 FILE -o NEW.stl` for its surface",
    ),
    ("blend fbx dae abc usd usda usdc usdz x3d wrl", "open it in Blender, and export it as `.glb` or `.ply`"),
    ("3ds ac lwo lxo ms3d", "convert it with Assimp: `assimp export FILE NEW.ply`"),
    ("3mf amf", "open it in a slicer, such as PrusaSlicer, and export it as `.stl`"),
    (
        "3dm c4d catpart dwg dxf f3d fcstd ipt ma max mb mphtxt mphbin prt skp sldprt x_t",
        "export it as `.stl` or `.obj` from the program that made it",
    ),
    (
        "node ele bdf nas fem cgns e ex2 exo med mdpa meshb su2 ugrid vol xdmf xmf",
        "convert it with meshio: `meshio convert FILE NEW.vtu`",
    ),
    ("unv", "convert it with Gmsh: `gmsh FILE -save -o NEW.msh`"),
    ("cas", "convert it with meshio: `meshio convert --input-format ansys FILE NEW.vtu`"),
    ("cdb dyn key k neu", "write it as an Abaqus (`.inp`) or Gmsh (`.msh`) file from the program that made it"),
    (
        "odb op2 rst",
        "write its mesh as an Abaqus (`.inp`) or Gmsh (`.msh`) file, or its moments as `.vtu`, from the program that made it",
    ),
    ("frd", "convert it with ccx2paraview: `ccx2paraview FILE vtu`"),
    (
        "poly smesh",
        "mesh it with TetGen, `tetgen -p FILE`, and convert the result with meshio: `meshio convert FILE.1.node NEW.vtu`",
    ),
    ("h5 hdf5", "convert the `.xdmf` file that names it with meshio: `meshio convert FILE.xdmf NEW.vtu`"),
    ("pvtu vti vtkhdf vtm vtr vts", "open it in ParaView, and save it as `.vtu`"),
];

/// What converts a file to a format that is read, by its ending in small letters and without the dot. `None` for files that are no
/// meshes of a known kind.
pub fn converter(ending: &str) -> Option<&'static str> {
    CONVERTERS.iter().find(|(endings, _)| endings.split(' ').any(|known| known == ending)).map(|&(_, help)| help)
}
