//! A walk as arrays for numpy: a zip archive of `.npy` files, version 1.0 each.

use super::table::{coordinates, legs, real_joints};
use piaffe_optimizer::walk::{Moment, Walk};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Arrays by name, over the moments: `t` (n), `phase`, `stance` (n; whole numbers from 1, in flight 0), `p`, `pd`, `pdd` (n × 3: the platform's
/// mass centre), `q`, `qd`, `qdd` (n × coordinates), `torque` (n × joints), `force` (n × 3), `feet` (n × legs × 3), for each
/// real leg `chain_NAME` (n × points × 3: its joints from the platform down, and its foot); and the names `coordinates`, `joints` (of the virtual legs), `legs`, `real_joints`, and of each of the last the index of the coordinate
/// that it follows (`real_joint_of`). SI units, rad.
///
/// # Errors
/// None in practice: the archive is made in memory.
pub fn npz(walk: &Walk) -> std::io::Result<Vec<u8>> {
    let d = walk.description;
    let names: Vec<&str> = legs(d).map(|(_, _, name)| name).collect();
    let mut archive = Archive { zip: ZipWriter::new(Cursor::new(Vec::new())) };
    let mut put = |name: &str, shape: &[usize], value: &dyn Fn(&Moment) -> Vec<f64>| {
        let values: Vec<u8> = walk.moments.iter().flat_map(value).flat_map(f64::to_le_bytes).collect();
        let shape = [&[walk.moments.len()], shape].concat();
        archive.put(name, "<f8", &shape, &values)
    };
    put("t", &[], &|m| vec![m.time])?;
    for (k, name) in ["p", "pd", "pdd"].into_iter().enumerate() {
        put(name, &[3], &|m| m.platform[k].to_vec())?;
    }
    let count = d.orientations();
    put("q", &[count], &|m| m.q.clone())?;
    put("qd", &[count], &|m| m.qd.clone())?;
    put("qdd", &[count], &|m| m.qdd.clone())?;
    put("torque", &[d.joints()], &|m| m.torque.clone())?;
    put("force", &[3], &|m| m.force.to_vec())?;
    let feet = |m: &Moment| legs(d).flat_map(|(l, k, _)| m.chain(d, l, k).pop().unwrap_or_default()).collect();
    put("feet", &[names.len(), 3], &feet)?;
    for (leg, member, name) in legs(d) {
        let points = d.legs[leg].members[member].bodies.len() + 1;
        put(&format!("chain_{name}"), &[points, 3], &|m| m.chain(d, leg, member).concat())?;
    }
    let count = |of: fn(&Moment) -> usize| walk.moments.iter().map(of).collect::<Vec<_>>();
    archive.indices("phase", &count(|m| m.phase + 1))?;
    archive.indices("stance", &count(|m| m.mode.stance().map_or(0, |leg| leg + 1)))?;
    let of: Vec<String> = coordinates(d);
    archive.words("coordinates", &of.iter().map(String::as_str).collect::<Vec<_>>())?;
    archive.words("joints", &d.joints.iter().map(|j| j.name).collect::<Vec<_>>())?;
    archive.words("legs", &names)?;
    let (of, real): (Vec<usize>, Vec<&str>) = real_joints(d).unzip();
    archive.words("real_joints", &real)?;
    archive.indices("real_joint_of", &of)?;
    Ok(archive.zip.finish()?.into_inner())
}

struct Archive {
    zip: ZipWriter<Cursor<Vec<u8>>>,
}

impl Archive {
    fn put(&mut self, name: &str, kind: &str, shape: &[usize], values: &[u8]) -> std::io::Result<()> {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        self.zip.start_file(format!("{name}.npy"), options)?;
        let shape: String = shape.iter().map(|n| format!("{n},")).collect();
        let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
        // The values begin at a multiple of 64 bytes; the header ends with a line end.
        header += &" ".repeat(63 - (10 + header.len()) % 64);
        header.push('\n');
        self.zip.write_all(b"\x93NUMPY\x01\x00")?;
        self.zip.write_all(&(header.len() as u16).to_le_bytes())?;
        self.zip.write_all(header.as_bytes())?;
        self.zip.write_all(values)
    }

    /// An array of whole numbers.
    fn indices(&mut self, name: &str, numbers: &[usize]) -> std::io::Result<()> {
        let bytes: Vec<u8> = numbers.iter().flat_map(|k| (*k as i64).to_le_bytes()).collect();
        self.put(name, "<i8", &[numbers.len()], &bytes)
    }

    /// An array of texts: four bytes per character, all of one length.
    fn words(&mut self, name: &str, words: &[&str]) -> std::io::Result<()> {
        let length = words.iter().map(|w| w.chars().count()).max().unwrap_or(0).max(1);
        let padded = |w: &&str| w.chars().chain(std::iter::repeat('\0')).take(length).collect::<Vec<_>>();
        let bytes: Vec<u8> = words.iter().flat_map(padded).flat_map(|c| u32::from(c).to_le_bytes()).collect();
        self.put(name, &format!("<U{length}"), &[words.len()], &bytes)
    }
}
