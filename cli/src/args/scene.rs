use clap::Args;

/// What a scene is searched by.
#[derive(Args, Clone, Debug, Default)]
pub struct SceneArgs {
    /// A scene description to look for instead of an example: a file, or the text itself
    #[arg(long, value_name = "TEXT|FILE", conflicts_with_all = ["example", "features", "mode", "rate"])]
    pub scene: Option<String>,
}
