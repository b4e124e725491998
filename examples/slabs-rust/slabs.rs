// SPDX-License-Identifier: Apache-2.0
//! An accelerator in Rust: objects sorted along the longest axis and cut into at most 32 slabs. The objects of a slab are
//! tested if the ray hits the box around them.
use std::mem::{size_of, MaybeUninit};
use std::os::raw::{c_char, c_int, c_void};
use std::{ptr, slice};

// ---- raytally/types.h, box.h and accel.h; structs that raytally makes are declared up to the last member used ----

#[repr(C)]
struct Ray {
    org: [f32; 3],
    tmin: f32,
    dir: [f32; 3],
    tmax: f32,
    kind: u32,
    source: u32,
}

#[repr(C)]
struct Hit {
    t: f32,
    object: u32,
}

#[repr(C)]
struct Counters([u64; 32]);
const EXTENT_TESTS: usize = 4;
const STEPS: usize = 5;
const LEAF_STEPS: usize = 6;

#[repr(C)]
struct Bounds {
    lo: [f32; 3],
    hi: [f32; 3],
}

#[repr(C)]
struct Prepared {
    tmin: f32,
    tmax: f32,
    org: [f32; 4],
    dir: [f32; 4],
    inv: [f32; 4],
    org_near: [f32; 4],
    org_far: [f32; 4],
    negative: [u32; 4],
    first: [u32; 4],
    last: [u32; 4],
    ray: *const Ray,
    query: *const Query,
    own: [u64; 40],
}

#[repr(C)]
struct Query {
    host: *const Host,
}

#[repr(C)]
struct Host {
    abi: u32,
    size: u32,
    prepare: unsafe extern "C" fn(*const Query, *const Ray, *mut Prepared),
    object_hits: unsafe extern "C" fn(*const Prepared, *const u32, u32, c_int, *mut Hit, *mut Counters) -> c_int,
}

#[repr(C)]
struct BuildInput {
    size: u32,
    object_count: u32,
    boxes: *const Bounds,
    bounds: Bounds,
}

type Kernel<A> =
    unsafe extern "C" fn(*const c_void, *mut c_void, *const Query, *const Ray, usize, *mut A, *mut Counters);

#[repr(C)]
pub struct Ops {
    abi: u32,
    size: u32,
    name: *const c_char,
    summary: *const c_char,
    paper: *const c_char,
    params: *const c_void,
    param_count: u32,
    build: unsafe extern "C" fn(*const BuildInput, *mut *mut c_void) -> c_int,
    destroy: unsafe extern "C" fn(*mut c_void),
    nearest: Kernel<Hit>,
    occluded: Kernel<u32>,
    optional: [Option<unsafe extern "C" fn()>; 5], // query_bytes to each_box
    flags: u64,
}
unsafe impl Sync for Ops {} // its pointers are to constants

impl Prepared {
    /// raytally_box_hit with raytally_tmax, operation by operation: exactness depends on it.
    fn hits(&self, bounds: &Bounds, best: &Hit) -> bool {
        let bytes = (bounds as *const Bounds).cast::<u8>();
        let side = |offset: u32| unsafe { *bytes.add(offset as usize).cast::<f32>() };
        let (mut from, mut to) = (self.tmin, if best.t < self.tmax { best.t } else { self.tmax });
        for a in 0..3 {
            let near = (side(self.first[a]) - self.org_near[a]) * self.inv[a];
            let far = (side(self.last[a]) - self.org_far[a]) * self.inv[a];
            from = if near > from { near } else { from };
            to = if far < to { far } else { to };
        }
        from <= to
    }
}

// ---- build ----

struct Slab {
    bounds: Bounds,
    ids: Vec<u32>,
}

fn slabs(bounds: &Bounds, boxes: &[Bounds]) -> Vec<Slab> {
    let size = |a: usize| bounds.hi[a] - bounds.lo[a];
    let axis = (1..3).fold(0, |longest, a| if size(a) > size(longest) { a } else { longest });
    let place = |id: u32| boxes[id as usize].lo[axis] + boxes[id as usize].hi[axis];
    let mut ids: Vec<u32> = (0..boxes.len() as u32).collect();
    ids.sort_by(|&a, &b| place(a).total_cmp(&place(b))); // stable: objects at the same place stay ordered by number
    let slab = |ids: &[u32]| Slab { bounds: around(ids.iter().map(|&id| &boxes[id as usize])), ids: ids.to_vec() };
    ids.chunks(boxes.len() / 32 + 1).map(slab).collect()
}

fn around<'a>(boxes: impl Iterator<Item = &'a Bounds>) -> Bounds {
    let mut sum = Bounds { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };
    for other in boxes {
        for a in 0..3 {
            sum.lo[a] = sum.lo[a].min(other.lo[a]);
            sum.hi[a] = sum.hi[a].max(other.hi[a]);
        }
    }
    sum
}

unsafe extern "C" fn build(from: *const BuildInput, out: *mut *mut c_void) -> c_int {
    let from = &*from;
    let boxes = match from.object_count {
        0 => &[], // the pointer may be NULL
        count => slice::from_raw_parts(from.boxes, count as usize),
    };
    *out = Box::into_raw(Box::new(slabs(&from.bounds, boxes))).cast();
    0
}

unsafe extern "C" fn destroy(structure: *mut c_void) {
    drop(Box::from_raw(structure.cast::<Vec<Slab>>()));
}

// ---- trace ----

/// With counters that are a constant NULL it compiles to code that counts nothing.
#[inline(always)]
unsafe fn search(slabs: &[Slab], ray: &Prepared, any: bool, best: &mut Hit, counters: *mut Counters) {
    let count = |event: usize| {
        if let Some(counters) = counters.as_mut() {
            counters.0[event] += 1
        }
    };
    let object_hits = (*(*ray.query).host).object_hits;
    for slab in slabs {
        count(EXTENT_TESTS);
        if !ray.hits(&slab.bounds, best) {
            continue;
        }
        count(STEPS);
        count(LEAF_STEPS);
        if object_hits(ray, slab.ids.as_ptr(), slab.ids.len() as u32, any.into(), best, counters) != 0 {
            return;
        }
    }
}

impl From<Hit> for u32 {
    fn from(hit: Hit) -> u32 {
        hit.object
    }
}

/// `nearest`, whose answers are hits, and with ANY `occluded`, whose answers are the numbers of objects.
unsafe extern "C" fn kernel<A: From<Hit>, const ANY: bool>(
    structure: *const c_void,
    _memory: *mut c_void,
    query: *const Query,
    rays: *const Ray,
    count: usize,
    answers: *mut A,
    counters: *mut Counters,
) {
    let slabs = &*structure.cast::<Vec<Slab>>();
    for (i, ray) in slice::from_raw_parts(rays, count).iter().enumerate() {
        let mut best = Hit { t: f32::INFINITY, object: u32::MAX };
        let mut prepared = MaybeUninit::uninit();
        ((*(*query).host).prepare)(query, ray, prepared.as_mut_ptr());
        if counters.is_null() {
            search(slabs, prepared.assume_init_ref(), ANY, &mut best, ptr::null_mut());
        } else {
            search(slabs, prepared.assume_init_ref(), ANY, &mut best, counters.add(ray.kind as usize));
        }
        answers.add(i).write(best.into());
    }
}

// ---- the table ----

static OPS: Ops = Ops {
    abi: 1,
    size: size_of::<Ops>() as u32,
    name: "slabs-rust\0".as_ptr().cast(),
    summary: "objects sorted along one axis, in slabs with a box each\0".as_ptr().cast(),
    paper: "none: an exercise\0".as_ptr().cast(),
    params: ptr::null(),
    param_count: 0,
    build,
    destroy,
    nearest: kernel::<Hit, false>,
    occluded: kernel::<u32, true>,
    optional: [None; 5],
    flags: 0,
};

#[no_mangle]
pub extern "C" fn raytally_plugin(index: u32) -> *const Ops {
    if index == 0 {
        &OPS
    } else {
        ptr::null()
    }
}
