"""How tasks are handed out."""

from types import SimpleNamespace

from pipeline.running.batches import Batches


def sizes(left, block, seconds, width=2):
    """Of the batches that so many tasks leave in, on two workers."""
    batches = Batches()
    batches.heard(seconds)
    batches.add([SimpleNamespace(number=n) for n in range(left)], None, block)
    taken = []
    while batches:
        taken.append(batches.take(width).tasks)
    assert [task.number for tasks in taken for task in tasks] == list(range(left))
    return [len(tasks) for tasks in taken]


def test_short_tasks_leave_many_at_a_time():
    assert sizes(1000, 1, 0.001)[:3] == [100, 100, 100]
    assert sizes(1000, 1, 0.02)[0] == 25
    assert sizes(5, 1, 1.0) == [1] * 5


def test_so_they_do_in_this_process():
    """Many records go to one file, which is a third of what such a task takes; a few have each its own."""
    assert sizes(250, 1, 0.001, width=0) == [100, 100] + [1] * 50 and sizes(500, 1, 1.0, width=0) == [1] * 500


def test_what_shares_more_stays_together():
    """Batches begin where a block does, until there is less left than a block for each worker."""
    taken = sizes(1000, 10, 0.02)
    assert taken[0] == 20
    starts = [sum(taken[:n]) for n in range(len(taken))]
    assert all(start % 10 == 0 for start in starts if start < 900)
    assert sizes(100, 60, 0.02)[0] == 16  # a block that is larger than a batch is shared out


def test_batches_end_with_blocks_after_the_first_single_tasks():
    """Those go out one by one, before it is known how long a task takes."""
    batches = Batches()
    batches.add([SimpleNamespace(number=n) for n in range(1000)], None, 10)
    first = [len(batches.take(2).tasks) for _ in range(6)]
    batches.heard(0.02)
    then = [len(batches.take(2).tasks) for _ in range(5)]
    assert first == [1] * 6 and then == [24, 20, 20, 20, 20]
