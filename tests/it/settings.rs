//! Settings of the tests: those of another value, but for some.

/// `settings! { name: value, ..base }` is `base` with other values of the settings that are named.
#[macro_export]
macro_rules! settings {
    ($($name:ident $(: $value:expr)?),* $(,)? ; ..$base:expr) => {{
        #[allow(unused_mut, reason = "a list of settings may be empty")]
        let mut settings = $base;
        $($crate::settings!(@set settings $name $(: $value)?);)*
        settings
    }};
    (@set $settings:ident $name:ident : $value:expr) => { $settings.$name = $value };
    (@set $settings:ident $name:ident) => { $settings.$name = $name };
}
