//! A thread that is kept on an isolated processor.

#[cfg(target_os = "linux")]
#[test]
fn a_thread_is_kept_on_the_last_isolated_processor_or_stays_free() {
    use forcefeel_live::priority::pin;
    use rustix::thread::sched_getaffinity;
    let allowed = |isolated: &'static str| {
        let thread = std::thread::spawn(move || {
            let pinned = pin(isolated);
            let set = sched_getaffinity(None).expect("a set of processors");
            (pinned.is_ok(), set.count(), set.is_set(0))
        });
        thread.join().expect("a thread that ends")
    };
    let free = sched_getaffinity(None).expect("a set of processors").count();
    assert_eq!(allowed("0\n"), (true, 1, true));
    assert_eq!(allowed("7-9,0\n"), (true, 1, true));
    for none in ["\n", "", "9999999"] {
        let (pinned, count, _) = allowed(none);
        assert_eq!((pinned, count), (false, free));
    }
}
