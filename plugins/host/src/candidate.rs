//! From a plugin that was found to one that can be used.

use crate::discover::Candidate;
use crate::library::{Plugin, load};
use crate::manifest::Offered;
use crate::probe::probe;
use std::fs::File;
use std::io;
use std::process::Command;

impl Candidate {
    /// Tries its library in a process that `child` starts, which must call
    /// [`examine`](crate::examine), and then loads it.
    ///
    /// # Errors
    /// Why it cannot be used, for a user.
    pub fn load(&self, child: Command) -> Result<Plugin, String> {
        let probed = probe(child)?;
        self.check(&probed.offered)?;
        let plugin = load(&self.library).map_err(|fault| fault.to_string())?;
        self.check(&plugin.offered())?;
        Ok(plugin)
    }

    /// What a plugin offers must be what it is listed with.
    fn check(&self, offered: &Offered) -> Result<(), String> {
        let listed = &self.manifest.offered;
        for ((sort, listed), (_, offered)) in listed.sorts().into_iter().zip(offered.sorts()) {
            if listed != offered {
                return Err(format!(
                    "its manifest lists the {sort}s {listed:?}, its library offers {offered:?}: \
                     install it anew"
                ));
            }
        }
        Ok(())
    }

    /// Its version and the first digits of its library's hash, for caches: a library that was built
    /// anew is another one.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn fingerprint(&self) -> io::Result<String> {
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(File::open(&self.library)?)?;
        let hash = hasher.finalize().to_hex();
        // 64 bits tell apart whatever one user builds.
        Ok(format!("{} {}", self.manifest.version, &hash[..16]))
    }
}
