//! Four-channel texels from samples with fewer channels.

/// Converts interleaved samples to RGBA texels; grey is repeated, missing alpha is `one`.
pub(super) fn expand<T: Copy + Default>(samples: &[T], channels: u8, one: T) -> Vec<[T; 4]> {
    let mut texels = vec![[T::default(); 4]; samples.len() / usize::from(channels)];
    widen(samples, channels, one, &mut texels);
    texels
}

/// Like [`expand`], but writes into existing memory.
pub(super) fn widen<T: Copy>(samples: &[T], channels: u8, one: T, texels: &mut [[T; 4]]) {
    match channels {
        1 => each(samples, texels, |[v]| [v, v, v, one]),
        2 => each(samples, texels, |[v, a]| [v, v, v, a]),
        3 => each(samples, texels, |[r, g, b]| [r, g, b, one]),
        _ => each(samples, texels, |texel| texel),
    }
}

/// Converts samples with a channel count known at compile time.
fn each<T: Copy, const N: usize>(samples: &[T], texels: &mut [[T; 4]], texel: impl Fn([T; N]) -> [T; 4]) {
    for (to, samples) in texels.iter_mut().zip(samples.as_chunks().0) {
        *to = texel(*samples);
    }
}
