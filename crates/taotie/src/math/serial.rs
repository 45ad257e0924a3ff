//! Serialises vectors as arrays of their components.

use super::Vec3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

impl<L: Copy + Serialize> Serialize for Vec3<L> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [self.x, self.y, self.z].serialize(serializer)
    }
}

impl<'de, L: Deserialize<'de>> Deserialize<'de> for Vec3<L> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let [x, y, z] = <[L; 3]>::deserialize(deserializer)?;
        Ok(Self { x, y, z })
    }
}
