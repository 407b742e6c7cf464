//! Equations that stand among Rust code and are interpreted.

use nisp_runtime::kernel::SceneRef;

use crate::read;

/// Declares an equation with the words of `pde!`, and interprets it: the same schema and the same numbers, without kernels that have to be built.
///
/// Its module has one function, `scene(name)`. Mistakes show when that is called, not when the program is compiled.
///
/// ```
/// nisp_interpreter::interpret! {
///     /// A vessel that fills.
///     mod vessel {
///         coordinates: t [s];
///         fields: h [m];
///         sources: q [m/s];
///         on motion { balance: d(h, t) == q; }
///         on samples { observe h; }
///         scene filled { }
///     }
/// }
///
/// assert_eq!(vessel::scene("filled").schema.heads[1].name, "q");
/// ```
#[macro_export]
macro_rules! interpret {
    ($(#[$attribute:meta])* $visibility:vis mod $name:ident { $($body:tt)* }) => {
        $(#[$attribute])*
        $visibility mod $name {
            /// The scene of this name.
            pub(crate) fn scene(name: &str) -> $crate::SceneRef {
                $crate::scene(stringify!($($body)*), stringify!($name), name)
            }
        }
    };
}

/// A scene of an equation that is known to be right.
///
/// # Panics
/// If the text has a mistake, or no scene of this name.
pub fn scene(text: &str, equation: &str, name: &str) -> SceneRef {
    let read = read(text, equation).unwrap_or_else(|mistakes| panic!("{mistakes}"));
    read.scenes.into_iter().find(|scene| scene.schema.name == name).expect("a scene of this name")
}
