//! What a program needs to see whether it was built from the specification that is there now.

use super::tokens::{Written, print};
use quote::quote;

/// Name of the generated file.
pub const SPECIFICATION_FILE: &str = "specification.rs";

/// Source of the file with the folder of a specification, and the paths of its files with their SHA-256.
///
/// # Errors
/// None that is known: texts can always be written.
pub fn specification_source(folder: &str, files: &[(String, String)]) -> Written<String> {
    let files = files.iter().map(|(path, digest)| quote!((#path, #digest)));
    print(quote! {
        /// The folder of the specification, from the package's root.
        pub const FOLDER: &str = #folder;

        /// Its files when this was built, with their SHA-256.
        pub const FILES: &[(&str, &str)] = &[#(#files),*];
    })
}
