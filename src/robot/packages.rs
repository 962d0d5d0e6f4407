//! Where the files are that a URDF names: `package://NAME/...`, `file://...`, `$(find NAME)/...` or a path.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
};

/// Environment variables with folders that contain packages, and where in each folder these are.
const VARIABLES: [(&str, &str); 2] = [("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")];

/// The folders in which packages are looked for.
#[derive(Clone, Debug, Default)]
pub struct Packages {
    folders: Vec<PathBuf>,
    /// The folder of the URDF, for relative paths.
    urdf_folder: PathBuf,
}

impl Packages {
    /// The places where packages are looked for, in this order: `folders`, those of the environment variables
    /// `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`, and the folders above the URDF. This is the only place below `cli` that
    /// reads the environment.
    pub fn new(folders: Vec<PathBuf>, urdf_folder: &Path) -> Self {
        let of_variable = |(name, inside): (&str, &str)| {
            let value = std::env::var_os(name).unwrap_or_default();
            std::env::split_paths(&value).map(|folder| folder.join(inside)).collect::<Vec<_>>()
        };
        let absolute = urdf_folder.canonicalize().unwrap_or_else(|_| urdf_folder.to_owned());
        let above = absolute.ancestors().map(Path::to_owned);
        let folders = folders.into_iter().chain(VARIABLES.into_iter().flat_map(of_variable)).chain(above);
        Self {
            folders: folders.filter(|folder| !folder.as_os_str().is_empty()).collect(),
            urdf_folder: urdf_folder.to_owned(),
        }
    }

    /// The file that a URDF means.
    ///
    /// # Errors
    /// What was found and what was expected, if there is no such file.
    pub fn resolve(&self, uri: &str) -> Result<PathBuf, String> {
        if let Some((package, inside)) = package_of(uri) {
            return self.in_package(package, inside).ok_or_else(|| self.not_found(uri, package));
        }
        if uri.contains("$(") || uri.contains("${") {
            return Err(format!("found {uri}, an expression of xacro, expected a path: {XACRO_HINT}"));
        }
        if let Some(scheme) = ["http://", "https://"].into_iter().find(|scheme| uri.starts_with(scheme)) {
            return Err(format!("found {uri}, expected a file of this machine in place of {scheme}"));
        }
        let path = uri.strip_prefix("file://").map_or_else(|| self.urdf_folder.join(uri), PathBuf::from);
        if path.is_file() { Ok(path) } else { Err(format!("found no file {}", path.display())) }
    }

    /// The first folder that has the package and the file in it. A folder may contain the package or be it.
    fn in_package(&self, package: &str, inside: &str) -> Option<PathBuf> {
        let candidates = self.folders.iter().flat_map(|folder| {
            let itself = (folder.file_name() == Some(OsStr::new(package))).then(|| folder.join(inside));
            [Some(folder.join(package).join(inside)), itself]
        });
        // A package that was copied into a folder of another name.
        let renamed = self.folders.iter().map(|folder| folder.join(inside));
        candidates.flatten().chain(renamed).find(|path| path.is_file())
    }

    fn not_found(&self, uri: &str, package: &str) -> String {
        let has = |folder: &&PathBuf| folder.join(package).is_dir();
        let place = match self.folders.iter().find(has) {
            Some(folder) => format!("the package is {}, which has no such file", folder.join(package).display()),
            None => format!("no folder has the package {package}"),
        };
        format!(
            "found {uri}, but {place}; expected the folder that contains {package} in `packages` of the description, \
             in ROS_PACKAGE_PATH or above the urdf"
        )
    }
}

/// How a xacro becomes a URDF.
pub(super) const XACRO_HINT: &str = "expand the xacro first: `xacro FILE.xacro -o robot.urdf` (`pip install xacro`)";

/// The package and the path inside it.
fn package_of(uri: &str) -> Option<(&str, &str)> {
    let (package, inside) = match uri.strip_prefix("package://") {
        Some(rest) => rest.split_once('/')?,
        None => {
            let (package, inside) = uri.strip_prefix("$(find ")?.split_once(')')?;
            (package.trim(), inside.trim_start_matches('/'))
        }
    };
    Some((package, inside))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_is_found_in_a_folder_given_or_above_the_urdf() {
        let place = tempfile::tempdir().unwrap();
        let mesh = place.path().join("share/robot_description/meshes/arm.stl");
        let urdf_folder = place.path().join("share/robot_description/urdf");
        for folder in [mesh.parent().unwrap(), urdf_folder.as_path()] {
            std::fs::create_dir_all(folder).unwrap();
        }
        std::fs::write(&mesh, "").unwrap();
        let mesh = mesh.canonicalize().unwrap();
        let away = tempfile::tempdir().unwrap();
        let renamed = place.path().join("copies/arm");
        for folder in ["meshes", "urdf"] {
            std::fs::create_dir_all(renamed.join(folder)).unwrap();
        }
        std::fs::write(renamed.join("meshes/arm.stl"), "").unwrap();
        let share = place.path().join("share");
        let places = [
            Packages::new(Vec::new(), &urdf_folder),
            Packages::new(vec![share.clone()], away.path()),
            Packages::new(vec![share.join("robot_description")], away.path()),
        ];
        for packages in places {
            for uri in ["package://robot_description/meshes/arm.stl", "$(find robot_description)/meshes/arm.stl"] {
                assert_eq!(packages.resolve(uri).unwrap().canonicalize().unwrap(), mesh, "{uri}");
            }
        }
        // Under another name than the URDF has.
        let copy = Packages::new(Vec::new(), &renamed.join("urdf")).resolve("package://arm_support/meshes/arm.stl");
        assert_eq!(copy.unwrap().canonicalize().unwrap(), renamed.join("meshes/arm.stl").canonicalize().unwrap());
        let relative = Packages::new(Vec::new(), &urdf_folder).resolve("../meshes/arm.stl").unwrap();
        assert_eq!(relative.canonicalize().unwrap(), mesh);
        let absolute = format!("file://{}", mesh.display());
        assert_eq!(Packages::default().resolve(&absolute).unwrap(), mesh);
    }

    #[test]
    fn what_is_missing_is_told_apart() {
        let place = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(place.path().join("known")).unwrap();
        let packages = Packages::new(vec![place.path().to_owned()], place.path());
        for (uri, expected) in [
            ("package://known/a.stl", "which has no such file"),
            ("package://unknown/a.stl", "no folder has the package unknown"),
            ("$(find unknown)/a.stl", "no folder has the package unknown"),
            ("$(arg folder)/a.stl", "expand the xacro first"),
            ("${folder}/a.stl", "expand the xacro first"),
            ("https://example.org/a.stl", "in place of https://"),
            ("meshes/a.stl", "found no file"),
        ] {
            let error = packages.resolve(uri).unwrap_err();
            assert!(error.contains(expected), "{uri}: {error}");
        }
    }
}
