//! The kinds of parameters of materials, each in three stages.
//!
//! ```text
//!              described (scene file)   textured (built once)   value (at a hit)
//! Color        Textured                 Texture                 Spectrum
//! Share        Textured                 Texture                 f32, the mean of the colours
//! Number<T>    Varying<T>               texture::Number         f32
//! ```

use std::marker::PhantomData;

use glam::DVec3;

use super::HitContext;
use super::description::Prepare;
use crate::format::{Textured, Varying};
use crate::math::Spectrum;
use crate::texture::{self, Texture};

/// A kind of parameter.
pub trait Parameter {
    /// The parameter in a scene file.
    type Described;
    /// The parameter with its textures built.
    type Textured;
    /// The value of the parameter at a point.
    type Value;

    /// Builds the textures of the parameter.
    fn prepare(described: &Self::Described, key: &str, builder: &mut dyn Prepare) -> Self::Textured;

    /// Looks up the value at a hit.
    fn at(textured: &Self::Textured, at: &HitContext) -> Self::Value;

    /// The parameter after the world has been moved by −`origin`.
    fn recentred(textured: Self::Textured, origin: DVec3) -> Self::Textured;

    /// The colour or texture in the description, with its key; `None` for a plain number.
    fn described_texture<'d>(described: &'d Self::Described, key: &str) -> Option<(String, &'d Textured)>;

    /// The texture; `None` for a constant number.
    fn texture(textured: &Self::Textured) -> Option<&Texture>;
}

/// A reflected or transmitted colour.
pub struct Color;

/// A number from 0 to 1. A colour counts by its mean.
pub struct Share;

/// A number in the range of `T`.
pub struct Number<T>(PhantomData<T>);

/// A kind of parameter that is described by a colour or texture. The kinds differ in the value that they look up in it.
pub trait TextureParameter {
    /// The value of the parameter at a point.
    type Value;

    /// Looks up the value at a hit.
    fn value(texture: &Texture, at: &HitContext) -> Self::Value;
}

impl TextureParameter for Color {
    type Value = Spectrum;

    #[inline]
    fn value(texture: &Texture, at: &HitContext) -> Spectrum {
        Spectrum::from_albedo(texture.at(&at.texture))
    }
}

impl TextureParameter for Share {
    type Value = f32;

    #[inline]
    fn value(texture: &Texture, at: &HitContext) -> f32 {
        texture.scalar(&at.texture)
    }
}

impl<P: TextureParameter> Parameter for P {
    type Described = Textured;
    type Textured = Texture;
    type Value = P::Value;

    fn prepare(described: &Textured, key: &str, builder: &mut dyn Prepare) -> Texture {
        builder.texture(key, described)
    }

    #[inline]
    fn at(textured: &Texture, at: &HitContext) -> P::Value {
        P::value(textured, at)
    }

    fn recentred(textured: Texture, origin: DVec3) -> Texture {
        textured.recentred(origin)
    }

    fn described_texture<'d>(described: &'d Textured, key: &str) -> Option<(String, &'d Textured)> {
        Some((key.to_owned(), described))
    }

    fn texture(textured: &Texture) -> Option<&Texture> {
        Some(textured)
    }
}

impl<T: Copy + Into<f64>> Parameter for Number<T> {
    type Described = Varying<T>;
    type Textured = texture::Number;
    type Value = f32;

    fn prepare(described: &Varying<T>, key: &str, builder: &mut dyn Prepare) -> texture::Number {
        builder.number(key, described)
    }

    #[inline]
    fn at(textured: &texture::Number, at: &HitContext) -> f32 {
        textured.at(&at.texture)
    }

    fn recentred(textured: texture::Number, origin: DVec3) -> texture::Number {
        textured.recentred(origin)
    }

    fn described_texture<'d>(described: &'d Varying<T>, key: &str) -> Option<(String, &'d Textured)> {
        described.by().map(|by| (format!("{key}/by"), by))
    }

    fn texture(textured: &texture::Number) -> Option<&Texture> {
        textured.texture()
    }
}

/// Defines the stages of a model with parameters that are looked up independently of each other.
///
/// From one list of parameters it makes `described::Model` for scene files, `textured::Model` with textures, and the conversions
/// to `textured::Model` and to the model itself. Methods of [`TexturedModel`](super::TexturedModel) follow the list: `effects` is
/// required, others where their defaults do not hold.
///
/// ```ignore
/// parameters! {
///     /// Reflects like a perfect mirror. (The text of the scene format.)
///     Mirror {
///         /// The share of light that is reflected.
///         color: Color = Textured::white(),
///     }
///
///     fn effects(&self) -> Effects {
///         Effects::SPECULAR_REFLECTION
///     }
/// }
/// ```
///
/// Either all parameters have a default, or none has.
macro_rules! parameters {
    ($(#[$meta:meta])* $model:ident {
        $($(#[$doc:meta])* $field:ident: $kind:ident $(<$range:ident>)? = $default:expr,)+
    } $($methods:tt)+) => {
        parameters!(@stages [$(#[$meta])*] [default] $model { $($(#[$doc])* $field: $kind $(<$range>)?,)+ } $($methods)+);

        impl Default for described::$model {
            fn default() -> described::$model {
                described::$model { $($field: $default,)+ }
            }
        }
    };
    ($(#[$meta:meta])* $model:ident { $($(#[$doc:meta])* $field:ident: $kind:ident $(<$range:ident>)?,)+ } $($methods:tt)+) => {
        parameters!(@stages [$(#[$meta])*] [] $model { $($(#[$doc])* $field: $kind $(<$range>)?,)+ } $($methods)+);
    };
    (@stages [$($meta:tt)*] [$($default:ident)?] $model:ident { $($(#[$doc:meta])* $field:ident: $kind:ident $(<$range:ident>)?,)+ } $($methods:tt)+) => {
        /// The description in a scene file.
        pub mod described {
            $($(use $crate::format::$range;)?)+
            use $crate::bsdf::parameter::{self, Parameter};

            $($meta)*
            #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
            #[serde(deny_unknown_fields $(, $default)?)]
            pub struct $model {
                $($(#[$doc])* pub $field: <parameter::$kind $(<$range>)? as Parameter>::Described,)+
            }

            impl $crate::bsdf::description::Description for $model {
                fn textures(&self) -> Vec<(String, &$crate::format::Textured)> {
                    [$(<parameter::$kind $(<$range>)?>::described_texture(&self.$field, stringify!($field)),)+].into_iter().flatten().collect()
                }

                fn prepare(&self, builder: &mut dyn $crate::bsdf::description::Prepare) -> $crate::bsdf::Material {
                    super::textured::$model {
                        $($field: <parameter::$kind $(<$range>)?>::prepare(&self.$field, stringify!($field), builder),)+
                    }.into()
                }
            }
        }

        /// The model with its textures.
        pub mod textured {
            $($(use $crate::format::$range;)?)+
            use $crate::bsdf::parameter::{self, Parameter};

            /// The model with textures for parameters.
            #[derive(Clone, Debug, PartialEq)]
            #[allow(missing_docs, reason = "the parameters are explained where the model and its description are")]
            pub struct $model {
                $(pub $field: <parameter::$kind $(<$range>)? as Parameter>::Textured,)+
            }
        }

        impl $crate::bsdf::parameter::Lookup for textured::$model {
            type Model = $model;

            #[inline]
            fn at(&self, at: &$crate::bsdf::HitContext) -> $model {
                use $crate::bsdf::ScatteringModel as _;
                use $crate::bsdf::parameter::{self, Parameter};
                $model { $($field: <parameter::$kind $(<$range>)?>::at(&self.$field, at),)+ }.energy_conserving()
            }

            fn textures(&self) -> Vec<&$crate::texture::Texture> {
                use $crate::bsdf::parameter::{self, Parameter};
                [$(<parameter::$kind $(<$range>)?>::texture(&self.$field),)+].into_iter().flatten().collect()
            }

            fn recentred(self, origin: glam::DVec3) -> Self {
                use $crate::bsdf::parameter::{self, Parameter};
                textured::$model { $($field: <parameter::$kind $(<$range>)?>::recentred(self.$field, origin),)+ }
            }
        }

        impl $crate::bsdf::TexturedModel for textured::$model {
            $($methods)+
        }
    };
}

pub(super) use parameters;

/// The lookup of a model's parameters at a point.
pub trait Lookup: Sized {
    /// The result of the lookup: a model, or one of several.
    type Model;

    /// Looks up the parameters at a hit.
    fn at(&self, at: &HitContext) -> Self::Model;

    /// The textures of the parameters, including constant colours.
    fn textures(&self) -> Vec<&Texture>;

    /// The model after the world has been moved by −`origin`.
    fn recentred(self, origin: DVec3) -> Self;
}
