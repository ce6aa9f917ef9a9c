//! Whose frames an end of the link takes.
//!
//! In a session that runs both ends the supervisor draws one key for both, which
//! nobody else has. An end that runs alone has the keys of its host ([`LinkKeys`]).
//! Beyond this host there is no link without them; on it the first end that starts
//! makes a key, and both ends, which share the folder, trust it. One key of a host is
//! both: what seals frames, and what its certificate is made of.

use ferntast_bus::frames::{LinkDirection, LinkTls, is_loopback};
use ferntast_seal::{PrivateKey, PublicKey, Role, SecureEnd};
use serde::{Deserialize, Serialize};

use super::{
    SessionContext,
    link_keys::{LinkKeyError, LinkKeys, random},
};

/// What a session's file says of its link's keys.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkAccess {
    /// The key of both ends, where one session runs both. A secret.
    pub secret: Option<String>,
    /// Name of the known host to operate; `None` for the only one.
    pub peer: Option<String>,
}

/// An end of the link, as far as strangers are concerned.
pub struct LinkEnd {
    /// Opens and seals frames.
    pub secure: SecureEnd,
    /// By what it is known over TLS, and whom it trusts.
    pub tls: LinkTls,
}

/// The end of `session` that sends in that direction.
///
/// # Errors
///
/// [`LinkKeyError`].
pub fn link_end(session: &SessionContext, sends: LinkDirection) -> Result<LinkEnd, LinkKeyError> {
    let access = &session.link_access;
    let (own, role) = match &access.secret {
        Some(secret) => {
            let own = PrivateKey::from_text(secret).map_err(|source| LinkKeyError::Key {
                place: "the session's file".to_owned(),
                source,
            })?;
            let role = shared_role(&own, sends);
            (own, role)
        }
        None => {
            let endpoint = &session.loaded.scenario.link.endpoint;
            keys_of(
                &LinkKeys::of(None)?,
                endpoint,
                access.peer.as_deref(),
                sends,
            )?
        }
    };
    let tls = link_tls(&own, &role);
    let secure = SecureEnd::new(own, role, &session.session, random()?);
    Ok(LinkEnd { secure, tls })
}

/// What proves `own` over TLS to those whose frames it takes in `role`, and them to it.
pub fn link_tls(own: &PrivateKey, role: &Role) -> LinkTls {
    let known = match role {
        Role::Operator { peer } => std::slice::from_ref(peer),
        Role::Arm { known } => &known[..],
    };
    LinkTls {
        seed: own.certificate_seed(),
        known: known.iter().map(PublicKey::certificate).collect(),
    }
}

/// The role of an end that shares its key with the other.
fn shared_role(own: &PrivateKey, sends: LinkDirection) -> Role {
    let peer = own.public();
    match sends {
        LinkDirection::Forward => Role::Operator { peer },
        LinkDirection::Back => Role::Arm { known: vec![peer] },
    }
}

/// The end of `session` that sends in that direction, in virtual time: the key that
/// both ends of a host share and what this end draws come from `seed`. Two ends, or two
/// starts of one, differ in `number`, which is not 0.
pub fn seeded_end(
    session: &str,
    seed: u64,
    host: u8,
    number: u8,
    sends: LinkDirection,
) -> SecureEnd {
    let bytes = |number: u8| {
        let mut bytes = [number; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        bytes[8] = host;
        bytes
    };
    let own = PrivateKey::from_random(bytes(0));
    let role = shared_role(&own, sends);
    SecureEnd::new(own, role, session, bytes(number))
}

/// A key for both ends of one session.
///
/// # Errors
///
/// [`LinkKeyError::Random`].
pub fn draw_secret() -> Result<String, LinkKeyError> {
    Ok(PrivateKey::from_random(random()?).to_text())
}

/// The keys of an end that runs alone, whose link is at `endpoint`.
fn keys_of(
    keys: &LinkKeys,
    endpoint: &str,
    peer: Option<&str>,
    sends: LinkDirection,
) -> Result<(PrivateKey, Role), LinkKeyError> {
    let local = is_loopback(endpoint);
    let own = match keys.own()? {
        Some(own) => own,
        None if local => match keys.make() {
            Ok(own) => own,
            // The other end was quicker.
            Err(LinkKeyError::Exists { .. }) => {
                keys.own()?.ok_or_else(|| no_key(keys, endpoint))?
            }
            Err(error) => return Err(error),
        },
        None => return Err(no_key(keys, endpoint)),
    };
    let mut known = keys.known()?;
    if let Some(peer) = peer {
        let all = names(&known);
        known.retain(|(name, _)| name == peer);
        if known.is_empty() {
            return Err(LinkKeyError::WhichPeer { known: all });
        }
    } else if local {
        // Whoever can read the key may as well be the other end.
        known = match sends {
            LinkDirection::Forward => vec![("this host".to_owned(), own.public())],
            LinkDirection::Back => {
                known.push(("this host".to_owned(), own.public()));
                known
            }
        };
    }
    if known.is_empty() {
        return Err(LinkKeyError::NobodyKnown {
            endpoint: endpoint.to_owned(),
            folder: keys.folder().to_owned(),
        });
    }
    let role = match (sends, &known[..]) {
        (LinkDirection::Back, _) => Role::Arm {
            known: known.iter().map(|(_, key)| *key).collect(),
        },
        (LinkDirection::Forward, [(_, key)]) => Role::Operator { peer: *key },
        (LinkDirection::Forward, _) => {
            let known = names(&known);
            return Err(LinkKeyError::WhichPeer { known });
        }
    };
    Ok((own, role))
}

fn no_key(keys: &LinkKeys, endpoint: &str) -> LinkKeyError {
    LinkKeyError::NoKey {
        endpoint: endpoint.to_owned(),
        folder: keys.folder().to_owned(),
    }
}

fn names(known: &[(String, PublicKey)]) -> String {
    let names: Vec<&str> = known.iter().map(|(name, _)| name.as_str()).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::{super::link_keys::tests::Folder, *};

    const THERE: &str = "quic/10.0.0.2:7448";
    const HERE: &str = "tcp/127.0.0.1:7448";

    #[test]
    fn beyond_this_host_there_is_no_link_without_keys() {
        let (_folder, keys) = Folder::keys("beyond");
        for sends in [LinkDirection::Forward, LinkDirection::Back] {
            let error = keys_of(&keys, THERE, None, sends).unwrap_err();
            assert!(matches!(error, LinkKeyError::NoKey { .. }), "{error}");
            assert!(error.to_string().contains("ferntast link keys new"));
        }
        keys.make().unwrap();
        let error = keys_of(&keys, THERE, None, LinkDirection::Back).unwrap_err();
        assert!(matches!(error, LinkKeyError::NobodyKnown { .. }), "{error}");
    }

    #[test]
    fn on_this_host_it_needs_no_step() {
        let (_folder, keys) = Folder::keys("here");
        let (own, role) = keys_of(&keys, HERE, None, LinkDirection::Back).unwrap();
        let (again, other) = keys_of(&keys, HERE, None, LinkDirection::Forward).unwrap();
        assert_eq!(own, again);
        assert!(matches!(role, Role::Arm { known } if known == [own.public()]));
        assert!(matches!(other, Role::Operator { peer } if peer == own.public()));
    }

    #[test]
    fn known_hosts_are_chosen_by_name() {
        let (_folder, keys) = Folder::keys("chosen");
        keys.make().unwrap();
        let other = |number| PrivateKey::from_random([number; 32]).public();
        keys.add("arm", &other(1).to_string()).unwrap();
        let forward = LinkDirection::Forward;
        let (_, role) = keys_of(&keys, THERE, None, forward).unwrap();
        assert!(matches!(role, Role::Operator { peer } if peer == other(1)));
        keys.add("other", &other(2).to_string()).unwrap();
        let error = keys_of(&keys, THERE, None, forward).unwrap_err();
        assert!(error.to_string().contains("arm, other"), "{error}");
        let (_, role) = keys_of(&keys, THERE, Some("other"), forward).unwrap();
        assert!(matches!(role, Role::Operator { peer } if peer == other(2)));
        assert!(keys_of(&keys, THERE, Some("none"), forward).is_err());
        let (own, role) = keys_of(&keys, THERE, None, LinkDirection::Back).unwrap();
        let tls = link_tls(&own, &role);
        assert_eq!(tls.known, [other(1), other(2)].map(|key| key.certificate()));
        assert!(matches!(role, Role::Arm { known } if known == [other(1), other(2)]));
    }
}
