-- What is known of the worker that has the work, should it be heard of no more: how full its memory was, or how its process ended.
ALTER TABLE work ADD COLUMN worker_note TEXT;
