//! [`Group`]: a group of users that may share a domain, and the names of users and groups.

use std::fs;

use crate::Error;

/// A group of users that the files of a domain are opened to.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Group {
    name: String,
    gid: u32,
}

impl Group {
    /// Finds the group with this name in `/etc/group`, or with this number.
    ///
    /// # Errors
    /// [`Error::InvalidGroup`] if there is none.
    pub fn find(name: &str) -> Result<Self, Error> {
        let gid = id_of("/etc/group", name).or_else(|| name.parse().ok());
        match gid {
            Some(gid) => {
                Ok(Self { name: name_of("/etc/group", gid).unwrap_or_else(|| name.to_owned()), gid })
            }
            None => Err(Error::InvalidGroup {
                group: name.to_owned(),
                reason:
                    "it is neither in /etc/group nor a number (make it: groupadd NAME; usermod -aG NAME USER)"
                        .to_owned(),
            }),
        }
    }

    /// Returns the group that the environment variable `BELVEDERE_GROUP` names.
    pub(crate) fn from_env() -> Result<Option<Self>, Error> {
        match std::env::var_os("BELVEDERE_GROUP") {
            Some(name) if !name.is_empty() => Self::find(&name.to_string_lossy()).map(Some),
            _ => Ok(None),
        }
    }

    /// Returns the group's name, or its number if it has no name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the group id.
    #[must_use]
    pub fn gid(&self) -> u32 {
        self.gid
    }

    /// Returns true if this process belongs to the group, and so may give files to it.
    pub(crate) fn has_this_process(&self) -> bool {
        let own = |gid: rustix::process::Gid| gid.as_raw() == self.gid;
        rustix::process::geteuid().is_root()
            || own(rustix::process::getegid())
            || rustix::process::getgroups().is_ok_and(|groups| groups.into_iter().any(own))
    }
}

/// Formats a user for messages: `anna (user id 1001)`.
pub(crate) fn user(uid: u32) -> String {
    match name_of("/etc/passwd", uid) {
        Some(name) => format!("{name} (user id {uid})"),
        None => format!("user id {uid}"),
    }
}

/// Parses the lines of `/etc/passwd` or `/etc/group`, which begin with `NAME:PASSWORD:ID:`.
fn entries(text: &str) -> impl Iterator<Item = (&str, u32)> {
    text.lines().filter_map(|line| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        Some((name, fields.nth(1)?.parse().ok()?))
    })
}

fn name_of(database: &str, id: u32) -> Option<String> {
    let text = fs::read_to_string(database).ok()?;
    entries(&text).find(|(_, found)| *found == id).map(|(name, _)| name.to_owned())
}

fn id_of(database: &str, name: &str) -> Option<u32> {
    let text = fs::read_to_string(database).ok()?;
    entries(&text).find(|(found, _)| *found == name).map(|(_, id)| id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_have_names_or_numbers() {
        let root = Group::find("root").unwrap();
        assert_eq!((root.name(), root.gid()), ("root", 0));
        assert_eq!(Group::find("0").unwrap(), root);
        assert_eq!(Group::find("4123456").unwrap().name(), "4123456");
        assert!(Group::find("no such group").unwrap_err().to_string().contains("groupadd"));
        assert_eq!(user(0), "root (user id 0)");
        assert_eq!(user(4_123_456), "user id 4123456");
    }

    #[test]
    fn broken_lines_are_skipped() {
        let found: Vec<_> = entries("a:x:1:\nb\n\nc:x:y:\nd:x:2").collect();
        assert_eq!(found, [("a", 1), ("d", 2)]);
    }
}
