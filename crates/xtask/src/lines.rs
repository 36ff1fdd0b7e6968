//! Counts the lines of each crate's sources, those of its tests apart: code, and all with comments and blank lines.

use std::path::{Path, PathBuf};
use std::{collections::BTreeSet, fs, io};

use anyhow::Result;

/// Prints a table of the crates of a repository.
pub(crate) fn print(root: &Path) -> Result<()> {
    let mut crates: Vec<PathBuf> =
        fs::read_dir(root.join("crates"))?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    crates.sort();
    println!("{:16}{:>9}{:>9}", "crate", "code", "all");
    let mut sum = [0, 0];
    for folder in crates {
        let [code, all] = count(&folder.join("src"))?;
        println!("{:16}{code:>9}{all:>9}", folder.file_name().unwrap_or_default().to_string_lossy());
        sum = [sum[0] + code, sum[1] + all];
    }
    println!("{:16}{:>9}{:>9}", "all", sum[0], sum[1]);
    Ok(())
}

fn count(folder: &Path) -> Result<[usize; 2]> {
    let mut sources = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                sources.push((path.with_extension(""), fs::read_to_string(path)?));
            }
        }
    }
    // Modules of files of their own, without `.rs`.
    let mut tests = BTreeSet::new();
    for (path, text) in &sources {
        let is_root =
            path.file_name().is_some_and(|name| ["lib", "main", "mod"].iter().any(|root| name == *root));
        let below = if is_root { path.parent().unwrap_or(path) } else { path };
        for declaration in text.split("#[cfg(test)]\n").skip(1) {
            let line = declaration.lines().find(|line| !line.starts_with("#[")).unwrap_or_default();
            tests.extend(
                line.strip_suffix(';').and_then(|it| it.split_once("mod ")).map(|(_, name)| below.join(name)),
            );
        }
    }
    let is_product = |path: &Path| !path.ancestors().any(|above| tests.contains(above));
    let mut sum = [0, 0];
    for (_, text) in sources.iter().filter(|(path, _)| is_product(path)) {
        // Tests in the file of what they test are at its end.
        let product = text.split("\n#[cfg(test)]\nmod tests {\n").next().unwrap_or_default();
        let is_code = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
        sum = [sum[0] + product.lines().filter(is_code).count(), sum[1] + product.lines().count()];
    }
    Ok(sum)
}
