//! What a user is told where the compiler itself is wrong.

use crate::arguments::MessageFormat;
use crate::terminal::json::Message;
use std::panic::PanicHookInfo;

/// Where mistakes of the compiler are reported.
const REPORT: &str = concat!(env!("CARGO_PKG_REPOSITORY"), "/issues");

/// From now on a panic says that it is our mistake and where to report it. `RUST_BACKTRACE` shows the rest.
pub fn explain_panics(format: MessageFormat) {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let message = format!("this is a mistake in sdfc, not in your scene: {}", describe(info));
        let help = format!("please report it, with the scene and the command, at {REPORT}");
        match format {
            MessageFormat::Json => {
                eprint!("{}", Message::without_place("error", &message, Some(&help)).line())
            }
            MessageFormat::Human | MessageFormat::Short => eprintln!("sdfc: {message}\nsdfc: {help}"),
        }
        if std::env::var_os("RUST_BACKTRACE").is_some_and(|value| value != "0") {
            usual(info);
        }
    }));
}

fn describe(info: &PanicHookInfo) -> String {
    let message = info.payload_as_str().unwrap_or("no message");
    match info.location() {
        Some(place) => format!("{message} ({}:{}, version {})", place.file(), place.line(), sdfc::VERSION),
        None => message.to_string(),
    }
}
