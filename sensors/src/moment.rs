//! Where everything is, and when: what a [`Scene`] leaves open.

use crate::pose::Pose;
use crate::scene::Scene;

/// Where the sensor and all instances are at one moment.
///
/// A scene holds shapes and looks, and no poses, so that one scene can be seen at many moments: those of a rolling
/// shutter, or the last frame's.
///
/// ```
/// use belvedere_sensors::{Moment, Pose, scene::*};
/// let mut builder = SceneBuilder::new();
/// let material = builder.add_material(&MaterialConfig::default())?;
/// builder.add_instance(&InstanceConfig { material, ..Default::default() })?;
/// // The poses that the builder keeps …
/// let now = builder.moment(Pose::IDENTITY);
/// // … or others.
/// let moved = [Pose::from_translation(glam::DVec3::X * 2.0)];
/// let later = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: &moved };
/// assert_eq!(now.world_from_instance[0].translation().x, 0.0);
/// assert_eq!(later.world_from_instance[0].translation().x, 2.0);
/// # Ok::<(), SceneError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// Where the sensor is. It looks along +x; z is up.
    pub world_from_sensor: Pose,
    /// Where each instance of the scene is, by its index: as many as the scene has instances. One whose pose is not
    /// finite is nowhere, and seen by nobody.
    pub world_from_instance: &'a [Pose],
}

impl Moment<'_> {
    /// # Panics
    /// When there is not one pose for each instance.
    pub(crate) fn check(&self, scene: &Scene<'_>) {
        let (poses, instances) = (self.world_from_instance.len(), scene.instances().len());
        assert!(
            poses == instances,
            "a moment must have one pose for each instance of the scene: it has {poses}, and there are {instances}"
        );
    }
}

/// A frame to be taken: its number, and the moment at which it is taken.
///
/// ```
/// use belvedere_sensors::{Capture, Moment, Pose};
/// let nothing = Moment { world_from_sensor: Pose::IDENTITY, world_from_instance: &[] };
/// assert_eq!(Capture::new(7, nothing).frame, 7);
/// ```
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Capture<'a> {
    /// Number of the frame. Noise is a function of seed, sensor, frame and sample.
    pub frame: u64,
    /// Where everything is.
    pub moment: Moment<'a>,
}

impl<'a> Capture<'a> {
    /// A frame that is taken all at one moment.
    pub const fn new(frame: u64, moment: Moment<'a>) -> Self {
        Self { frame, moment }
    }
}
