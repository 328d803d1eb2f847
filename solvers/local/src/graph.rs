//! Subdomains of the graph of W, whose contacts are neighbours where W couples them.

use crate::LocalProblem;
use contact::SetupError;

/// The subdomain of each contact, of `count` with nearly equal numbers of contacts. Each is halved again and again in the order in
/// which contacts are reached from one that is far from others, so that few neighbours are parted.
///
/// # Errors
/// If there are more subdomains than contacts, or none.
pub(crate) fn subdomains(problem: &LocalProblem, count: usize) -> Result<Vec<u32>, SetupError> {
    let contacts = problem.contact_count();
    let expected = || format!("1 to {contacts}, the number of contacts");
    SetupError::unless((1..=contacts.max(1)).contains(&count), "subdomains", count, expected())?;
    let mut subdomain = vec![0; contacts];
    let all: Vec<u32> = (0..contacts as u32).collect();
    split(problem, &all, 0..count as u32, &mut subdomain);
    Ok(subdomain)
}

/// Distributes `contacts`, all of one subdomain so far, over those of `range`.
fn split(problem: &LocalProblem, contacts: &[u32], range: std::ops::Range<u32>, subdomain: &mut [u32]) {
    for contact in contacts {
        subdomain[*contact as usize] = range.start;
    }
    if range.len() == 1 {
        return;
    }
    let middle = range.start + range.len() as u32 / 2;
    // What is reached last is far from where it began.
    let far = reached(problem, contacts, contacts[0], subdomain).last().copied();
    let order = reached(problem, contacts, far.unwrap_or(contacts[0]), subdomain);
    let (first, second) = order.split_at(contacts.len() * (middle - range.start) as usize / range.len());
    split(problem, second, middle..range.end, subdomain);
    split(problem, first, range.start..middle, subdomain);
}

/// `contacts`, which are all of one subdomain, in the order in which they are reached `from` one of them, breadth first; where no
/// more can be reached, from the first of the others.
fn reached(problem: &LocalProblem, contacts: &[u32], from: u32, subdomain: &[u32]) -> Vec<u32> {
    let own = subdomain[from as usize];
    let mut order = Vec::with_capacity(contacts.len());
    let mut is_reached = vec![false; problem.contact_count()];
    for start in std::iter::once(&from).chain(contacts) {
        if std::mem::replace(&mut is_reached[*start as usize], true) {
            continue;
        }
        let mut next = order.len();
        order.push(*start);
        while let Some(contact) = order.get(next) {
            next += 1;
            for neighbour in problem.neighbours(*contact as usize) {
                let at = *neighbour as usize;
                if subdomain[at] == own && !std::mem::replace(&mut is_reached[at], true) {
                    order.push(*neighbour);
                }
            }
        }
    }
    order
}
