"""Who may come in, on PostgreSQL; the tests are those of `tests.api.test_access`."""

from tests.api.test_access import (
    test_a_login_link_is_good_once,
    test_a_new_login_link_voids_the_unused_ones_before_it_and_ends_no_session,
    test_a_token_signs_in_and_its_use_is_noted,
    test_nobody_waits_for_a_writer_to_be_known_or_refused,
    test_wrong_codes_are_bounded_in_number_and_a_good_one_is_taken_all_the_same,
)
