"""Reports, drafts, snapshots, orders and searches of the run list on PostgreSQL; the tests are those of SQLite."""

from tests.api.test_drafts import (
    test_a_draft_knows_the_run_that_came_of_it,
    test_deleting_is_noted_and_a_number_is_never_given_again,
    test_saving_goes_on_from_the_version_that_was_opened,
)
from tests.api.test_edits import test_notes_that_somebody_else_changed_are_not_written_over
from tests.api.test_listing import (
    crowd,
    test_facets_say_what_the_list_can_be_narrowed_to,
    test_filters_and_counts,
    test_pages_together_are_the_whole_list_in_order,
    test_pinned_runs_come_first_in_every_order,
    test_search_words_are_all_to_be_found,
)
from tests.api.test_reports import (
    run,
    test_it_has_every_section_and_figure,
    test_its_numbers_are_those_that_are_stored,
)
from tests.api.test_snapshots import (
    test_runs_of_the_same_components_share_one_snapshot,
    test_the_digest_of_earlier_results_is_what_it_was,
    test_the_worker_that_begins_a_run_says_what_its_components_mean,
    test_what_is_installed_later_changes_nothing_of_what_a_run_says,
)
