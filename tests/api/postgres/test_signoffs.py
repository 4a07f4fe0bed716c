"""Sign-offs and the digest of results on PostgreSQL; the tests are those of `tests.api.test_signoffs`."""

from tests.api.test_signoffs import (
    run,
    test_a_file_made_before_a_sign_off_is_not_taken_for_the_one_after,
    test_a_later_change_of_a_result_shows,
    test_a_reviewer_signs_off_what_was_reviewed,
    test_a_sign_off_is_withdrawn_once_and_stays_on_record,
    test_the_same_word_is_taken_once,
    test_what_people_write_on_a_run_is_no_result,
)
