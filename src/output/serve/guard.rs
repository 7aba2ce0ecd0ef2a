//! Who may watch: those who have the token of the address.
//!
//! The token is 128 random bits. Another site that a browser shows cannot know it. Such a site could also give its own name the address of this
//! machine (DNS rebinding); therefore the server answers only to numbers, to `localhost`, and to the name that the user gave.

use std::io;
use std::net::IpAddr;

use axum::http::header::HOST;
use axum::http::{HeaderMap, Uri};

/// What a request must know.
pub struct Guard {
    token: String,
    /// Name that the user gave to the address.
    host: String,
}

impl Guard {
    /// Makes a token.
    ///
    /// # Errors
    /// Those of the system's random numbers.
    pub fn new(host: &str) -> io::Result<Guard> {
        let mut random = [0; 16];
        getrandom::fill(&mut random).map_err(|e| io::Error::other(e.to_string()))?;
        Ok(Guard { token: random.iter().map(|byte| format!("{byte:02x}")).collect(), host: host.to_owned() })
    }

    /// The token.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// Whether the request has the token and names this server.
    pub fn admits(&self, uri: &Uri, headers: &HeaderMap) -> bool {
        let has_token = parameter(uri, "token").is_some_and(|token| is_same(token, &self.token));
        let named = headers.get(HOST).and_then(|host| host.to_str().ok());
        has_token && named.is_some_and(|host| self.is_named(host))
    }

    /// Whether a host of a request, with or without a port, is this server.
    fn is_named(&self, host: &str) -> bool {
        let name = match host.strip_prefix('[') {
            Some(rest) => rest.split(']').next().unwrap_or_default(),
            None => host.split(':').next().unwrap_or_default(),
        };
        name.parse::<IpAddr>().is_ok() || [&*self.host, "localhost"].iter().any(|own| own.eq_ignore_ascii_case(name))
    }
}

/// Value of a parameter of the query. Numbers and tokens need no decoding.
pub fn parameter<'a>(uri: &'a Uri, name: &str) -> Option<&'a str> {
    uri.query()?.split('&').find_map(|pair| pair.strip_prefix(name)?.strip_prefix('='))
}

/// Comparison whose time does not tell how much of a guess is right.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |found, (a, b)| found | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn admits(guard: &Guard, uri: &str, host: Option<&str>) -> bool {
        let mut headers = HeaderMap::new();
        host.map(|host| headers.insert(HOST, host.parse().expect("a header")));
        guard.admits(&uri.parse().expect("an address"), &headers)
    }

    /// The token is needed whole, and numbers and known names are the only hosts.
    #[test]
    fn only_the_token_and_known_hosts_are_admitted() {
        let guard = Guard::new("render-box").expect("random numbers");
        let token = guard.token();
        assert!(token.len() == 32 && token != Guard::new("render-box").expect("random numbers").token());
        let right = format!("/picture?since=3&token={token}");
        for host in ["127.0.0.1:8000", "127.0.0.1", "localhost:1", "LOCALHOST", "[::1]:8000", "[::1]", "render-box:80", "192.168.1.7:8000"]
        {
            assert!(admits(&guard, &right, Some(host)), "{host}");
        }
        for host in
            ["attacker.example", "attacker.example:8000", "127.0.0.1.attacker.example", "localhost.attacker.example", "", "[", "::1"]
        {
            assert!(!admits(&guard, &right, Some(host)), "{host}");
        }
        assert!(!admits(&guard, &right, None));
        let wrong = [
            "/".to_owned(),
            "/?token=".into(),
            format!("/?token={}", &token[1..]),
            format!("/?tokens={token}"),
            format!("/?token={token}0"),
        ];
        let flipped = token.replace(&token[..1], if token.starts_with('0') { "1" } else { "0" });
        for uri in wrong.into_iter().chain([format!("/?token={flipped}"), format!("/{token}")]) {
            assert!(!admits(&guard, &uri, Some("localhost")), "{uri}");
        }
    }
}
