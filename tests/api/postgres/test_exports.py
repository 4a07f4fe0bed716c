"""Files of a run on PostgreSQL; the tests are those of `tests.api.test_exports`."""

from tests.api.test_exports import (
    run,
    test_every_evaluation_is_a_row_with_all_its_digits,
    test_everything_as_json,
    test_flights_as_csv_hold_every_row,
    test_flights_as_mat_file,
    test_what_did_not_change_is_not_sent_again,
)
